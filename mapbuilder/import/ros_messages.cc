#include "mapbuilder/import/ros_messages.h"

#include "mapbuilder/import/cdr_reader.h"

namespace waymark {
namespace {

tl::unexpected<Error> another_encoding() {
  return fail(ErrorKind::bad_data, "a message that is not serialized as CDR");
}

tl::unexpected<Error> ends_early() {
  return fail(ErrorKind::bad_data, "a message that ends before its last field");
}

/// std_msgs/msg/Header: when the image was taken. Where it was taken is not asked for.
Expected<Stamp> take_header(CdrReader& in) {
  constexpr std::uint32_t kNanoseconds = 1'000'000'000;
  const auto s = in.number<std::int32_t>();
  const auto ns = in.number<std::uint32_t>();
  (void)in.text();  // frame_id
  if (in.failed()) return ends_early();
  if (s < 0 || ns >= kNanoseconds) {
    return fail(ErrorKind::bad_data, "header.stamp is none: {} s, {} ns", s, ns);
  }
  return std::chrono::seconds(s) + Stamp(ns);
}

template <typename Array>
void take_numbers(CdrReader& in, Array& numbers) {
  for (double& number : numbers) number = in.number<double>();
}

}  // namespace

Expected<RosImage> parse_ros_image(std::span<const std::uint8_t> message) {
  auto in = CdrReader::open(message);
  if (!in) return another_encoding();
  const auto stamp = take_header(*in);
  if (!stamp) return tl::make_unexpected(stamp.error());
  RosImage image;
  image.stamp = *stamp;
  image.height_px = in->number<std::uint32_t>();
  image.width_px = in->number<std::uint32_t>();
  image.encoding = in->text();
  image.big_endian = in->number<std::uint8_t>() != 0;
  image.step_bytes = in->number<std::uint32_t>();
  image.data = in->bytes();
  if (in->failed()) return ends_early();
  return image;
}

Expected<RosCompressedImage> parse_ros_compressed_image(std::span<const std::uint8_t> message) {
  auto in = CdrReader::open(message);
  if (!in) return another_encoding();
  const auto stamp = take_header(*in);
  if (!stamp) return tl::make_unexpected(stamp.error());
  RosCompressedImage image;
  image.stamp = *stamp;
  image.format = in->text();
  image.data = in->bytes();
  if (in->failed()) return ends_early();
  return image;
}

Expected<RosCameraInfo> parse_ros_camera_info(std::span<const std::uint8_t> message) {
  constexpr std::size_t kMostCoefficients = 16;
  auto in = CdrReader::open(message);
  if (!in) return another_encoding();
  if (const auto stamp = take_header(*in); !stamp) return tl::make_unexpected(stamp.error());
  RosCameraInfo info;
  info.height_px = in->number<std::uint32_t>();
  info.width_px = in->number<std::uint32_t>();
  info.distortion_model = in->text();
  const auto coefficients = in->number<std::uint32_t>();
  if (coefficients > kMostCoefficients) {
    return fail(ErrorKind::bad_data, "a camera_info with {} coefficients", coefficients);
  }
  info.distortion.resize(coefficients);
  take_numbers(*in, info.distortion);
  take_numbers(*in, info.camera_matrix);
  take_numbers(*in, info.rectification);
  take_numbers(*in, info.projection_matrix);
  const auto binning_x = in->number<std::uint32_t>();
  const auto binning_y = in->number<std::uint32_t>();
  const auto offset_x = in->number<std::uint32_t>();
  const auto offset_y = in->number<std::uint32_t>();
  const auto roi_height = in->number<std::uint32_t>();
  const auto roi_width = in->number<std::uint32_t>();
  (void)in->number<std::uint8_t>();  // do_rectify
  if (in->failed()) return ends_early();
  const bool cropped = (roi_height != 0 && roi_height != info.height_px) ||
                       (roi_width != 0 && roi_width != info.width_px);
  info.binned = binning_x > 1 || binning_y > 1 || offset_x > 0 || offset_y > 0 || cropped;
  return info;
}

}  // namespace waymark
