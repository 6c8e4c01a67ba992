#include "drivers/v4l2/capture_format.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "drivers/v4l2/capture_capability.h"
#include "drivers/v4l2/node_error.h"

namespace waymark {
namespace {

/// Broken drivers could list for ever.
constexpr std::uint32_t kMaxListed = 64;

/// Whether the device's buffers have several planes; config when it does not capture by streaming.
Expected<bool> is_multiplanar(VideoNode& node) {
  const auto can = capture_capability(node);
  if (!can) return tl::make_unexpected(can.error());
  if (!can->streams()) {
    return fail(ErrorKind::config, "{}: is no camera that streams; locd --list-cameras names those",
                node.path());
  }
  return can->multiplanar;
}

Expected<std::vector<std::uint32_t>> offered_fourccs(VideoNode& node, v4l2_buf_type type) {
  std::vector<std::uint32_t> fourccs;
  v4l2_fmtdesc format{};
  format.type = type;
  for (; format.index < kMaxListed; ++format.index) {
    const int failed = node.request(VIDIOC_ENUM_FMT, &format);
    if (failed != 0 && !says_absent(failed)) {
      return tl::make_unexpected(node_error(node, "can't list its formats", failed));
    }
    if (failed != 0) break;
    fourccs.push_back(format.pixelformat);
  }
  return fourccs;
}

struct Size {
  int width_px;
  int height_px;
};

std::vector<Size> offered_sizes(VideoNode& node, std::uint32_t fourcc) {
  std::vector<Size> sizes;
  v4l2_frmsizeenum size{};
  size.pixel_format = fourcc;
  for (; size.index < kMaxListed && node.request(VIDIOC_ENUM_FRAMESIZES, &size) == 0;
       ++size.index) {
    if (size.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      sizes.push_back(
          {static_cast<int>(size.discrete.width), static_cast<int>(size.discrete.height)});
      continue;
    }
    sizes.push_back(
        {static_cast<int>(size.stepwise.max_width), static_cast<int>(size.stepwise.max_height)});
    break;  // a range is the only entry
  }
  return sizes;
}

/// Whether the device lists a format in this size; a range counts by its ends.
bool lists_size(VideoNode& node, std::uint32_t fourcc, const CaptureRequest& request) {
  v4l2_frmsizeenum size{};
  size.pixel_format = fourcc;
  const auto width = static_cast<__u32>(request.width_px);
  const auto height = static_cast<__u32>(request.height_px);
  for (; size.index < kMaxListed && node.request(VIDIOC_ENUM_FRAMESIZES, &size) == 0;
       ++size.index) {
    if (size.type != V4L2_FRMSIZE_TYPE_DISCRETE) {
      const v4l2_frmsize_stepwise& range = size.stepwise;
      return width >= range.min_width && width <= range.max_width && height >= range.min_height &&
             height <= range.max_height;
    }
    if (size.discrete.width == width && size.discrete.height == height) return true;
  }
  return false;
}

/// The format to ask for: the requested one, else the best of those offered, in the requested size
/// if any is.
Expected<const PixelFormat*> choose_pixels(VideoNode& node, v4l2_buf_type type,
                                           const CaptureRequest& request) {
  const auto offered = offered_fourccs(node, type);
  if (!offered) return tl::make_unexpected(offered.error());
  const auto is_offered = [&](const PixelFormat& format) {
    return std::find(offered->begin(), offered->end(), format.fourcc) != offered->end();
  };
  if (request.pixels != nullptr) {
    if (is_offered(*request.pixels) || offered->empty()) return request.pixels;
  } else {
    const auto formats = pixel_formats();
    const auto in_size = std::find_if(formats.begin(), formats.end(), [&](const auto& format) {
      return is_offered(format) && lists_size(node, format.fourcc, request);
    });
    if (in_size != formats.end()) return &*in_size;
    const auto best = std::find_if(formats.begin(), formats.end(), is_offered);
    if (best != formats.end()) return &*best;
  }
  return fail(ErrorKind::config, "{}: does not deliver {}; it offers {}", node.path(),
              request.pixels != nullptr ? request.pixels->name : "any format that is understood",
              offered_formats(node));
}

void read_format(const v4l2_format& format, CaptureFormat& capture, std::uint32_t& fourcc) {
  if (capture.multiplanar) {
    const v4l2_pix_format_mplane& planes = format.fmt.pix_mp;
    fourcc = planes.pixelformat;
    capture.layout.width_px = static_cast<int>(planes.width);
    capture.layout.height_px = static_cast<int>(planes.height);
    capture.layout.stride_bytes = planes.plane_fmt[0].bytesperline;
    capture.planes = planes.num_planes;
  } else {
    fourcc = format.fmt.pix.pixelformat;
    capture.layout.width_px = static_cast<int>(format.fmt.pix.width);
    capture.layout.height_px = static_cast<int>(format.fmt.pix.height);
    capture.layout.stride_bytes = format.fmt.pix.bytesperline;
  }
}

/// Sets size and pixel format; the device must take both as they are.
Status set_format(VideoNode& node, const CaptureRequest& request, CaptureFormat& capture) {
  v4l2_format format{};
  format.type = capture.buffer_type();
  const auto width = static_cast<__u32>(request.width_px);
  const auto height = static_cast<__u32>(request.height_px);
  if (capture.multiplanar) {
    format.fmt.pix_mp.width = width;
    format.fmt.pix_mp.height = height;
    format.fmt.pix_mp.pixelformat = capture.layout.pixels->fourcc;
    format.fmt.pix_mp.field = V4L2_FIELD_NONE;
    format.fmt.pix_mp.num_planes = 1;
  } else {
    format.fmt.pix.width = width;
    format.fmt.pix.height = height;
    format.fmt.pix.pixelformat = capture.layout.pixels->fourcc;
    format.fmt.pix.field = V4L2_FIELD_NONE;
  }
  if (const int failed = node.request(VIDIOC_S_FMT, &format); failed != 0) {
    return tl::make_unexpected(node_error(node, "can't set the format", failed));
  }
  std::uint32_t fourcc = 0;
  read_format(format, capture, fourcc);
  if (fourcc != capture.layout.pixels->fourcc || capture.layout.width_px != request.width_px ||
      capture.layout.height_px != request.height_px) {
    return fail(ErrorKind::config,
                "{}: {} {}×{} px is wanted (rig.yaml's resolution), the device gives {} {}×{}; it "
                "offers {}",
                node.path(), capture.layout.pixels->name, request.width_px, request.height_px,
                fourcc_text(fourcc), capture.layout.width_px, capture.layout.height_px,
                offered_formats(node));
  }
  const auto row_bytes = static_cast<std::size_t>(capture.layout.width_px) *
                         static_cast<std::size_t>(capture.layout.pixels->bytes_per_pixel);
  if (capture.layout.stride_bytes == 0) capture.layout.stride_bytes = row_bytes;
  if (capture.layout.stride_bytes < row_bytes || capture.planes > VIDEO_MAX_PLANES) {
    return fail(ErrorKind::io, "{}: the driver states {} bytes per row of {} px, which can't be",
                node.path(), capture.layout.stride_bytes, capture.layout.width_px);
  }
  return {};
}

/// A device that crops shows another image than the one that was calibrated.
Status check_crop(VideoNode& node) {
  v4l2_selection whole{};
  whole.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  whole.target = V4L2_SEL_TGT_CROP_DEFAULT;
  v4l2_selection crop = whole;
  crop.target = V4L2_SEL_TGT_CROP;
  for (v4l2_selection* const asked : {&whole, &crop}) {
    const int failed = node.request(VIDIOC_G_SELECTION, asked);
    if (says_absent(failed)) return {};  // knows no cropping
    if (failed != 0) return tl::make_unexpected(node_error(node, "can't tell its crop", failed));
  }
  const v4l2_rect& a = crop.r;
  const v4l2_rect& b = whole.r;
  if (a.left == b.left && a.top == b.top && a.width == b.width && a.height == b.height) return {};
  return fail(
      ErrorKind::config,
      "{0}: crops {3}×{4} px at ({1}, {2}), where the whole image is {7}×{8} at ({5}, {6}); "
      "v4l2-ctl -d {0} --set-selection=target=crop,left={5},top={6},width={7},height={8}",
      node.path(), a.left, a.top, a.width, a.height, b.left, b.top, b.width, b.height);
}

double rate_of(const v4l2_fract& period) {
  return period.numerator > 0 ? static_cast<double>(period.denominator) / period.numerator : 0;
}

std::string offered_rates(VideoNode& node, const CaptureFormat& capture) {
  std::vector<std::string> rates;
  v4l2_frmivalenum interval{};
  interval.pixel_format = capture.layout.pixels->fourcc;
  interval.width = static_cast<__u32>(capture.layout.width_px);
  interval.height = static_cast<__u32>(capture.layout.height_px);
  for (; interval.index < kMaxListed && node.request(VIDIOC_ENUM_FRAMEINTERVALS, &interval) == 0;
       ++interval.index) {
    if (interval.type == V4L2_FRMIVAL_TYPE_DISCRETE) {
      rates.push_back(fmt::format("{:.4g}", rate_of(interval.discrete)));
      continue;
    }
    rates.push_back(fmt::format("{:.4g} to {:.4g}", rate_of(interval.stepwise.max),
                                rate_of(interval.stepwise.min)));
    break;
  }
  return rates.empty() ? "does not say which it can"
                       : fmt::format("can {}", fmt::join(rates, ", "));
}

Status set_rate(VideoNode& node, double fps, CaptureFormat& capture) {
  v4l2_streamparm parameters{};
  parameters.type = capture.buffer_type();
  v4l2_fract& period = parameters.parm.capture.timeperframe;
  int failed = node.request(VIDIOC_G_PARM, &parameters);
  const bool has_rate =
      failed == 0 && (parameters.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) != 0;
  if (says_absent(failed)) failed = 0;
  if (fps > 0 && has_rate) {
    period = {1000, static_cast<__u32>(std::lround(fps * 1000))};
    failed = node.request(VIDIOC_S_PARM, &parameters);
    // What was set may be told only when asked.
    if (failed == 0) failed = node.request(VIDIOC_G_PARM, &parameters);
  }
  if (failed != 0) {
    return tl::make_unexpected(node_error(node, "can't set the frame rate", failed));
  }
  capture.fps = has_rate ? rate_of(period) : 0;
  if (fps > 0 && std::abs(capture.fps - fps) > kSameRate * fps) {
    return fail(ErrorKind::config, "{}: fps = {} can't be set, the device does {:.4g}; it {}",
                node.path(), fps, capture.fps, offered_rates(node, capture));
  }
  return {};
}

}  // namespace

Expected<CaptureFormat> set_capture_format(VideoNode& node, const CaptureRequest& request) {
  CaptureFormat capture;
  const auto multiplanar = is_multiplanar(node);
  if (!multiplanar) return tl::make_unexpected(multiplanar.error());
  capture.multiplanar = *multiplanar;
  const auto pixels = choose_pixels(node, capture.buffer_type(), request);
  if (!pixels) return tl::make_unexpected(pixels.error());
  capture.layout.pixels = *pixels;
  if (auto set = set_format(node, request, capture); !set) return tl::make_unexpected(set.error());
  if (auto whole = check_crop(node); !whole) return tl::make_unexpected(whole.error());
  if (auto set = set_rate(node, request.fps, capture); !set) {
    return tl::make_unexpected(set.error());
  }
  return capture;
}

std::string offered_formats(VideoNode& node) {
  const auto multiplanar = is_multiplanar(node);
  if (!multiplanar) return "nothing";
  CaptureFormat type;
  type.multiplanar = *multiplanar;
  std::vector<std::string> formats;
  const auto fourccs = offered_fourccs(node, type.buffer_type());
  if (!fourccs) return fmt::format("nothing it could name ({})", fourccs.error().message);
  for (const std::uint32_t fourcc : *fourccs) {
    std::vector<std::string> sizes;
    for (const Size& size : offered_sizes(node, fourcc)) {
      sizes.push_back(fmt::format("{}×{}", size.width_px, size.height_px));
    }
    formats.push_back(fmt::format("{} {}", fourcc_text(fourcc), fmt::join(sizes, ", ")));
  }
  return formats.empty() ? "nothing" : fmt::format("{}", fmt::join(formats, "; "));
}

std::vector<OfferedFormat> understood_formats(VideoNode& node) {
  std::vector<OfferedFormat> understood;
  const auto multiplanar = is_multiplanar(node);
  if (!multiplanar) return understood;
  CaptureFormat type;
  type.multiplanar = *multiplanar;
  const auto offered = offered_fourccs(node, type.buffer_type());
  if (!offered) return understood;
  for (const PixelFormat& format : pixel_formats()) {
    if (std::find(offered->begin(), offered->end(), format.fourcc) == offered->end()) continue;
    auto sizes = offered_sizes(node, format.fourcc);
    if (sizes.empty()) sizes.push_back({0, 0});
    for (const Size& size : sizes) {
      understood.push_back({&format, size.width_px, size.height_px});
    }
  }
  return understood;
}

}  // namespace waymark
