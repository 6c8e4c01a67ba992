#include "core/capture/jpeg.h"
#include "mapbuilder/import/ros_image.h"
#include "mapbuilder/import/ros_messages.h"
#include "tests/fuzz/format.h"
#include "tests/fuzz/image_format.h"
#include "tests/support/recordings.h"

namespace waymark::test {
namespace {

constexpr Stamp kStamp{1'700'000'000'000'000'000};

/// As whichever of the three it may be; refused where it is none.
Expected<Stamp> read(const std::string& text) {
  const std::span<const std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(text.data()),
                                            text.size());  // NOLINT: bytes
  (void)parse_ros_camera_info(bytes);
  if (const auto compressed = parse_ros_compressed_image(bytes)) {
    if (const auto kind = kind_of_compressed(*compressed)) return compressed->stamp;
  }
  const auto image = parse_ros_image(bytes);
  if (!image) return tl::make_unexpected(image.error());
  const auto pgm = pgm_of_ros_image(*image);
  if (!pgm) return tl::make_unexpected(pgm.error());
  return image->stamp;
}

const AddFormat ros_message(
    {"RosMessage",
     {raw_image("/a", kStamp, image_seed()).data,
      raw_image("/a", kStamp, 4, 4, "bayer_grbg16", 8, std::string(32, 'b')).data,
      raw_image("/a", kStamp, 4, 2, "bgr8", 12, std::string(24, 'c')).data,
      compressed_image("/a", kStamp, "jpeg", encode_jpeg(image_seed().view(), 90).value()).data},
     {"mono8", "mono16", "rgb8", "bgra8", "bayer_rggb8", "bayer_gbrg16", "yuv422", "16UC1",
      std::string("\0\1\0\0", 4), "\xFF\xD8\xFF"},
     reader(read)});

}  // namespace
}  // namespace waymark::test
