#include "tests/vm/uvc_camera/usb_descriptors.h"

namespace waymark::uvc {
namespace {

enum StringIndex : std::uint8_t { kManufacturer = 1, kProductName = 2, kSerialNumber = 3 };

constexpr std::uint8_t kDevice = 1;
constexpr std::uint8_t kConfiguration = 2;
constexpr std::uint8_t kString = 3;
constexpr std::uint8_t kInterface = 4;
constexpr std::uint8_t kEndpoint = 5;
constexpr std::uint8_t kInterfaceAssociation = 11;
constexpr std::uint8_t kClassInterface = 0x24;

constexpr std::uint8_t kFormatIndex = 1;
constexpr std::uint8_t kOutputTerminal = 3;

/// A descriptor begins with its own length.
Bytes with_length(const Bytes& content) {
  Bytes descriptor{static_cast<std::uint8_t>(content.size() + 1)};
  put(descriptor, content);
  return descriptor;
}

Bytes interface(std::uint8_t number, std::uint8_t endpoints, std::uint8_t subclass) {
  return with_length({kInterface, number, 0, endpoints, kVideoClass, subclass, 0, 0});
}

/// UVC 1.0, 3.7.2: what the picture comes from and how it can be changed.
Bytes control_interface() {
  const Bytes camera =
      with_length({kClassInterface, 2, kCameraTerminal, 0x01, 0x02, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0x0A,
                   0, 0});  // bmControls: automatic exposure mode, exposure time
  const Bytes processing = with_length({kClassInterface, 5, kProcessingUnit, kCameraTerminal, 0, 0,
                                        2, 0x01, 0x02, 0});  // brightness, gain
  const Bytes output =
      with_length({kClassInterface, 3, kOutputTerminal, 0x01, 0x01, 0, kProcessingUnit, 0});
  Bytes header{kClassInterface, 1};
  put16(header, 0x0100);  // UVC 1.0
  const std::size_t header_bytes = 13;
  put16(header, static_cast<std::uint32_t>(header_bytes + camera.size() + processing.size() +
                                           output.size()));
  put32(header, 48'000'000);  // Hz, of a clock that nothing here uses
  put(header, {1, kStreamInterface});

  Bytes bytes = interface(kControlInterface, 0, 1);
  for (const Bytes& part : {with_length(header), camera, processing, output}) put(bytes, part);
  return bytes;
}

/// Payload UVC 1.0 "Uncompressed", 3.1.1: the format by its GUID, here Y800.
Bytes grey_format() {
  return with_length({kClassInterface,
                      4,
                      kFormatIndex,
                      1,
                      'Y',
                      '8',
                      '0',
                      '0',
                      0,
                      0,
                      0x10,
                      0,
                      0x80,
                      0,
                      0,
                      0xAA,
                      0,
                      0x38,
                      0x9B,
                      0x71,
                      8,
                      1,
                      0,
                      0,
                      0,
                      0});
}

/// Payload UVC 1.0 "MJPEG", 3.1.1.
Bytes mjpeg_format() {
  return with_length({kClassInterface, 6, kFormatIndex, 1, 0, 1, 0, 0, 0, 0});
}

Bytes frame_size(const CameraFormat& format) {
  const bool grey = format.pixels == PixelFormat::grey;
  Bytes frame{kClassInterface, static_cast<std::uint8_t>(grey ? 5 : 7), 1, 0};
  put16(frame, format.width_px);
  put16(frame, format.height_px);
  const auto bits_per_s =
      static_cast<std::uint32_t>(static_cast<double>(format.max_frame_bytes) * 8 * format.fps);
  put32(frame, bits_per_s);  // lowest
  put32(frame, bits_per_s);  // highest
  put32(frame, format.max_frame_bytes);
  put32(frame, format.uvc_interval());  // by default
  frame.push_back(1);                   // one interval follows
  put32(frame, format.uvc_interval());
  return with_length(frame);
}

/// UVC 1.0, 3.9.2: what is sent.
Bytes stream_interface(const CameraFormat& format) {
  const Bytes image = format.pixels == PixelFormat::grey ? grey_format() : mjpeg_format();
  const Bytes frame = frame_size(format);
  Bytes header{kClassInterface, 1, 1};
  const std::size_t header_bytes = 14;
  put16(header, static_cast<std::uint32_t>(header_bytes + image.size() + frame.size()));
  put(header, {kStreamEndpoint, 0, kOutputTerminal, 0, 0, 0, 1, 0});
  Bytes endpoint{kEndpoint, kStreamEndpoint, 2};
  put16(endpoint, kBulkPacketBytes);
  endpoint.push_back(0);

  Bytes bytes = interface(kStreamInterface, 1, 2);
  for (const Bytes& part : {with_length(header), image, frame, with_length(endpoint)}) {
    put(bytes, part);
  }
  return bytes;
}

}  // namespace

Bytes device_descriptor() {
  Bytes bytes{kDevice};
  put16(bytes, 0x0200);          // USB 2.0
  put(bytes, {0xEF, 2, 1, 64});  // interfaces are grouped; 64-byte control packets
  put16(bytes, kVendor);
  put16(bytes, kProduct);
  put16(bytes, kRelease);
  put(bytes, {kManufacturer, kProductName, kSerialNumber, 1});  // one configuration
  return with_length(bytes);
}

Bytes configuration_descriptor(const CameraFormat& format) {
  Bytes body =
      with_length({kInterfaceAssociation, kControlInterface, 2, kVideoClass, 3, 0, kProductName});
  put(body, control_interface());
  put(body, stream_interface(format));
  Bytes bytes{9, kConfiguration};
  put16(bytes, static_cast<std::uint32_t>(9 + body.size()));
  put(bytes, {2, 1, 0, 0x80, 250});  // 2 interfaces, number 1, powered by the bus, 500 mA
  put(bytes, body);
  return bytes;
}

std::optional<Bytes> string_descriptor(std::uint8_t index, const CameraFormat& format) {
  if (index == 0) return Bytes{4, kString, 0x09, 0x04};  // English is all there is
  std::string text;
  switch (index) {
    case kManufacturer:
      text = "Waymark";
      break;
    case kProductName:
      text = "Emulated camera";
      break;
    case kSerialNumber:
      text = format.serial;
      break;
    default:
      return std::nullopt;
  }
  Bytes content{kString};
  for (const char c : text) put16(content, static_cast<std::uint8_t>(c));
  return with_length(content);
}

}  // namespace waymark::uvc
