#include "tests/vm/uvc_camera/uvc_device.h"

#include <charconv>
#include <nlohmann/json.hpp>

#include "tests/vm/uvc_camera/usb_descriptors.h"

namespace waymark::uvc {
namespace {

// bmRequestType's kind, bits 5 and 6, and recipient, bits 0 to 4.
constexpr std::uint8_t kKindMask = 0x60;
constexpr std::uint8_t kClassRequest = 0x20;
constexpr std::uint8_t kRecipientMask = 0x1F;
constexpr std::uint8_t kToEndpoint = 2;

constexpr std::uint8_t kGetStatus = 0;
constexpr std::uint8_t kClearFeature = 1;
constexpr std::uint8_t kGetDescriptor = 6;

constexpr std::uint8_t kCommitControl = 2;
constexpr std::uint8_t kNegotiationBytes = 26;

/// What probe and commit agree on (UVC 1.0, 4.3.1.1): there is nothing to choose.
Bytes negotiation(const CameraFormat& format) {
  Bytes bytes;
  put16(bytes, 0);     // hints
  put(bytes, {1, 1});  // format, frame
  put32(bytes, format.uvc_interval());
  bytes.resize(18);  // key frames, compression: none
  put32(bytes, format.max_frame_bytes);
  put32(bytes, kMaxPayloadBytes);
  return bytes;
}

constexpr int kMaxShort = 1'000'000;

/// N, 0 to `most`, of an order that is `word` and N.
std::optional<int> number_after(std::string_view word, std::string_view order, int most) {
  if (!order.starts_with(word)) return std::nullopt;
  const std::string_view digits = order.substr(word.size());
  int number = 0;
  const auto [end, error] = std::from_chars(digits.begin(), digits.end(), number);
  if (error != std::errc{} || end != digits.end() || number < 0 || number > most) return {};
  return number;
}

}  // namespace

std::optional<Bytes> UvcDevice::answer(const ControlRequest& request, Instant now) {
  std::optional<Bytes> bytes;
  if ((request.type & kKindMask) != kClassRequest) {
    bytes = standard(request);
  } else if ((request.index & 0xFFU) == kControlInterface) {
    bytes = controls_.answer(request);
  } else if ((request.index & 0xFFU) == kStreamInterface) {
    bytes = negotiate(request, now);
  }
  if (bytes && bytes->size() > request.length) bytes->resize(request.length);
  return bytes;
}

std::optional<Bytes> UvcDevice::standard(const ControlRequest& request) {
  if (request.request == kGetStatus) return Bytes{0, 0};
  if (request.request == kClearFeature && (request.type & kRecipientMask) == kToEndpoint) {
    // How uvcvideo ends a stream whose endpoint is a bulk one.
    if ((request.index & 0xFFU) == kStreamEndpoint) stream_.stop();
    return Bytes{};
  }
  if (request.request != kGetDescriptor) return std::nullopt;
  switch (request.value >> 8U) {
    case 1:
      return device_descriptor();
    case 2:
      return configuration_descriptor(stream_.format());
    case 3:
      return string_descriptor(static_cast<std::uint8_t>(request.value), stream_.format());
    default:
      return std::nullopt;
  }
}

std::optional<Bytes> UvcDevice::negotiate(const ControlRequest& request, Instant now) {
  switch (request.request) {
    case kSetCurrent:
      if ((request.value >> 8U) == kCommitControl) stream_.start(now);
      return Bytes{};
    case kGetLength:
      return Bytes{kNegotiationBytes, 0};
    case kGetInfo:
      return Bytes{3};
    default:
      return negotiation(stream_.format());
  }
}

std::string UvcDevice::obey(std::string_view order) {
  if (order == "status") return status();
  if (order == "stall") {
    stream_.stall(true);
  } else if (order == "freeze") {
    stream_.freeze(true);
  } else if (order == "mute") {
    mute_ = true;
  } else if (order == "go") {
    stream_.stall(false);
    stream_.freeze(false);
    stream_.shorten(0);
    stream_.paint(std::nullopt);
    mute_ = false;
  } else if (const auto frames = number_after("short ", order, kMaxShort)) {
    stream_.shorten(*frames);
  } else if (const auto grey = number_after("paint ", order, 255)) {
    if (stream_.format().pixels != PixelFormat::grey) return "error: paint is for grey pixels";
    stream_.paint(static_cast<std::uint8_t>(*grey));
  } else {
    return "error: the orders are stall, freeze, mute, short N, paint GREY, go and status";
  }
  return "ok";
}

std::string UvcDevice::status() const {
  const VideoStream::Counts& counts = stream_.counts();
  nlohmann::json json{{"streaming", stream_.streaming()},
                      {"starts", counts.starts},
                      {"sent", counts.sent},
                      {"skipped", counts.skipped}};
  for (const auto& control : controls_.all()) json[control.name] = control.current;
  return json.dump();
}

}  // namespace waymark::uvc
