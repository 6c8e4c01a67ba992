#pragma once

#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "drivers/v4l2/video_node.h"

namespace waymark::test {

/// One control of a scripted device.
struct FakeControl {
  int low = 0;
  int high = 0;
  int step = 1;
  int value = 0;
  bool stuck = false;       ///< takes values and keeps its own
  std::set<int> refused{};  ///< EINVAL
  int failure = 0;          ///< of every request about it
};

/// One frame that a scripted device delivers.
struct FakeFrame {
  std::vector<std::uint8_t> bytes;
  std::uint32_t sequence = 0;
  Stamp stamp{0};
  std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
};

/// A scripted camera: what it offers, what it does to requests, what it delivers.
struct FakeDevice {
  VideoDevice identity{"/dev/video0", {}, "usb-1", "4711", "Fake"};
  std::map<std::uint32_t, std::vector<std::pair<int, int>>> formats{
      {V4L2_PIX_FMT_GREY, {{64, 48}}}};
  bool multiplanar = false;
  std::size_t stride_bytes = 0;  ///< 0: none stated
  double fps = 30;
  bool fps_is_fixed = false;
  bool has_crop = false;
  v4l2_rect crop{0, 0, 64, 48};
  v4l2_rect whole{0, 0, 64, 48};
  std::map<std::uint32_t, FakeControl> controls;
  std::size_t most_buffers = 32;
  bool captures = true;                   ///< false: a node of metadata
  std::vector<DeviceHolder> holders;      ///< have it open; it is busy
  std::map<unsigned long, int> failures;  ///< requests that fail, with what
  std::deque<FakeFrame> frames;           ///< to be delivered
  bool gone = false;                      ///< unplugged
  bool error_in_poll = false;
  std::function<void()> during_request;
  std::function<void()> during_wait;

  // What came of it.
  std::set<std::uint32_t> queued;  ///< buffers that the driver has
  std::vector<std::shared_ptr<std::vector<std::uint8_t>>> memory;
  bool streams = false;
  int opened = 0;  ///< nodes open now
  int opens = 0;   ///< ever
  int starts = 0;
  __u32 priority = V4L2_PRIORITY_UNSET;
  std::vector<std::pair<std::uint32_t, int>> written;  ///< controls, in order
};

class FakeVideoNode final : public VideoNode {
 public:
  explicit FakeVideoNode(FakeDevice& device) : device_(device) {
    ++device_.opened;
    ++device_.opens;
  }
  FakeVideoNode(const FakeVideoNode&) = delete;
  FakeVideoNode& operator=(const FakeVideoNode&) = delete;
  ~FakeVideoNode() override { --device_.opened; }

  [[nodiscard]] const std::string& path() const override { return device_.identity.node; }
  [[nodiscard]] std::vector<DeviceHolder> holders() const override { return device_.holders; }

  [[nodiscard]] bool wait(Stamp /*deadline*/, int interrupt) override {
    if (device_.during_wait) device_.during_wait();
    pollfd raised{interrupt, POLLIN, 0};
    if (::poll(&raised, 1, 0) > 0) return false;
    return !device_.frames.empty() || device_.gone || device_.error_in_poll;
  }

  [[nodiscard]] std::shared_ptr<const std::uint8_t> map(std::size_t length,
                                                        std::int64_t offset) override {
    auto bytes = std::make_shared<std::vector<std::uint8_t>>(length);
    device_.memory.resize(std::max(device_.memory.size(), static_cast<std::size_t>(offset) + 1));
    device_.memory[static_cast<std::size_t>(offset)] = bytes;
    return {bytes, bytes->data()};
  }

  [[nodiscard]] int request(unsigned long code, void* argument) override {
    if (device_.during_request) device_.during_request();
    if (device_.gone) return ENODEV;
    if (const auto failure = device_.failures.find(code); failure != device_.failures.end()) {
      return failure->second;
    }
    switch (code) {
      case VIDIOC_QUERYCAP:
        return capabilities(*static_cast<v4l2_capability*>(argument));
      case VIDIOC_ENUM_FMT:
        return list_format(*static_cast<v4l2_fmtdesc*>(argument));
      case VIDIOC_ENUM_FRAMESIZES:
        return list_size(*static_cast<v4l2_frmsizeenum*>(argument));
      case VIDIOC_ENUM_FRAMEINTERVALS:
        return list_interval(*static_cast<v4l2_frmivalenum*>(argument));
      case VIDIOC_S_FMT:
        return set_format(*static_cast<v4l2_format*>(argument));
      case VIDIOC_G_SELECTION:
        return selection(*static_cast<v4l2_selection*>(argument));
      case VIDIOC_G_PARM:
      case VIDIOC_S_PARM:
        return rate(*static_cast<v4l2_streamparm*>(argument), code == VIDIOC_S_PARM);
      case VIDIOC_S_PRIORITY:
        device_.priority = *static_cast<__u32*>(argument);
        return 0;
      case VIDIOC_QUERYCTRL:
        return query_control(*static_cast<v4l2_queryctrl*>(argument));
      case VIDIOC_G_CTRL:
      case VIDIOC_S_CTRL:
        return control(*static_cast<v4l2_control*>(argument), code == VIDIOC_S_CTRL);
      default:
        return request_of_buffers(code, argument);
    }
  }

 private:
  int capabilities(v4l2_capability& about) const {
    const __u32 capture =
        device_.multiplanar ? V4L2_CAP_VIDEO_CAPTURE_MPLANE : V4L2_CAP_VIDEO_CAPTURE;
    about.device_caps = V4L2_CAP_STREAMING | (device_.captures ? capture : V4L2_CAP_META_CAPTURE);
    about.capabilities = about.device_caps | capture | V4L2_CAP_DEVICE_CAPS;
    // Bounded fields, not necessarily ended by a zero.
    std::copy_n(device_.identity.bus.begin(),
                std::min(device_.identity.bus.size(), sizeof about.bus_info),
                std::begin(about.bus_info));
    std::copy_n(device_.identity.card.begin(),
                std::min(device_.identity.card.size(), sizeof about.card), std::begin(about.card));
    return 0;
  }
  int list_format(v4l2_fmtdesc& format) const {
    if (format.index >= device_.formats.size()) return EINVAL;
    format.pixelformat = std::next(device_.formats.begin(), format.index)->first;
    return 0;
  }
  int list_size(v4l2_frmsizeenum& size) const {
    const auto sizes = device_.formats.find(size.pixel_format);
    if (sizes == device_.formats.end() || size.index >= sizes->second.size()) return EINVAL;
    size.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    size.discrete = {static_cast<__u32>(sizes->second[size.index].first),
                     static_cast<__u32>(sizes->second[size.index].second)};
    return 0;
  }
  int list_interval(v4l2_frmivalenum& interval) const {
    if (interval.index > 0) return EINVAL;
    interval.type = V4L2_FRMIVAL_TYPE_DISCRETE;
    interval.discrete = {1, static_cast<__u32>(device_.fps)};
    return 0;
  }
  /// Takes the nearest that it has, as drivers do.
  int set_format(v4l2_format& format) {
    __u32 fourcc = device_.multiplanar ? format.fmt.pix_mp.pixelformat : format.fmt.pix.pixelformat;
    if (!device_.formats.contains(fourcc)) fourcc = device_.formats.begin()->first;
    const auto& sizes = device_.formats[fourcc];
    std::pair<int, int> size{
        static_cast<int>(device_.multiplanar ? format.fmt.pix_mp.width : format.fmt.pix.width),
        static_cast<int>(device_.multiplanar ? format.fmt.pix_mp.height : format.fmt.pix.height)};
    if (std::find(sizes.begin(), sizes.end(), size) == sizes.end()) size = sizes.front();
    length_ = static_cast<std::size_t>(size.first * size.second * 4);
    if (device_.multiplanar) {
      format.fmt.pix_mp.width = static_cast<__u32>(size.first);
      format.fmt.pix_mp.height = static_cast<__u32>(size.second);
      format.fmt.pix_mp.pixelformat = fourcc;
      format.fmt.pix_mp.num_planes = 2;
      format.fmt.pix_mp.plane_fmt[0].bytesperline = static_cast<__u32>(device_.stride_bytes);
    } else {
      format.fmt.pix.width = static_cast<__u32>(size.first);
      format.fmt.pix.height = static_cast<__u32>(size.second);
      format.fmt.pix.pixelformat = fourcc;
      format.fmt.pix.bytesperline = static_cast<__u32>(device_.stride_bytes);
    }
    return 0;
  }
  int selection(v4l2_selection& selection) const {
    if (!device_.has_crop) return ENOTTY;
    selection.r = selection.target == V4L2_SEL_TGT_CROP ? device_.crop : device_.whole;
    return 0;
  }
  int rate(v4l2_streamparm& parameters, bool set) {
    v4l2_captureparm& capture = parameters.parm.capture;
    if (set && !device_.fps_is_fixed) {
      device_.fps =
          static_cast<double>(capture.timeperframe.denominator) / capture.timeperframe.numerator;
    }
    if (device_.fps > 0) capture.capability = V4L2_CAP_TIMEPERFRAME;
    capture.timeperframe = {1000, static_cast<__u32>(device_.fps * 1000)};
    return 0;
  }
  int query_control(v4l2_queryctrl& query) const {
    const auto found = device_.controls.find(query.id);
    if (found == device_.controls.end()) return EINVAL;
    if (found->second.failure != 0) return found->second.failure;
    query.minimum = found->second.low;
    query.maximum = found->second.high;
    query.step = found->second.step;
    return 0;
  }
  int control(v4l2_control& control, bool set) {
    const auto found = device_.controls.find(control.id);
    if (found == device_.controls.end()) return EINVAL;
    FakeControl& of_device = found->second;
    if (of_device.failure != 0) return of_device.failure;
    if (set && of_device.refused.contains(control.value)) return EINVAL;
    if (set) device_.written.emplace_back(control.id, control.value);
    if (set && !of_device.stuck) of_device.value = control.value;
    control.value = of_device.value;
    return 0;
  }

  int request_of_buffers(unsigned long code, void* argument) {
    switch (code) {
      case VIDIOC_REQBUFS: {
        auto& request = *static_cast<v4l2_requestbuffers*>(argument);
        if (!device_.holders.empty()) return EBUSY;
        request.count = std::min(request.count, static_cast<__u32>(device_.most_buffers));
        device_.queued.clear();
        device_.memory.clear();
        return 0;
      }
      case VIDIOC_QUERYBUF: {
        auto& buffer = *static_cast<v4l2_buffer*>(argument);
        if (device_.multiplanar) {
          buffer.m.planes[0].length = static_cast<__u32>(length_);
          buffer.m.planes[0].m.mem_offset = buffer.index;
        } else {
          buffer.length = static_cast<__u32>(length_);
          buffer.m.offset = buffer.index;
        }
        return 0;
      }
      case VIDIOC_QBUF:
        return device_.queued.insert(static_cast<v4l2_buffer*>(argument)->index).second ? 0
                                                                                        : EINVAL;
      case VIDIOC_DQBUF:
        return deliver(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_STREAMON:
        ++device_.starts;
        device_.streams = true;
        return 0;
      case VIDIOC_STREAMOFF:
        device_.streams = false;
        return 0;
      default:
        return ENOTTY;
    }
  }
  int deliver(v4l2_buffer& buffer) {
    if (device_.frames.empty() || device_.queued.empty()) return EAGAIN;
    const FakeFrame frame = std::move(device_.frames.front());
    device_.frames.pop_front();
    buffer.index = *device_.queued.begin();
    device_.queued.erase(device_.queued.begin());
    std::vector<std::uint8_t>& memory = *device_.memory[buffer.index];
    std::copy_n(frame.bytes.begin(), std::min(frame.bytes.size(), memory.size()), memory.begin());
    buffer.flags = frame.flags;
    buffer.sequence = frame.sequence;
    buffer.timestamp.tv_sec = frame.stamp / std::chrono::seconds(1);
    buffer.timestamp.tv_usec = frame.stamp % std::chrono::seconds(1) / std::chrono::microseconds(1);
    if (device_.multiplanar) {
      buffer.m.planes[0].bytesused = static_cast<__u32>(frame.bytes.size());
    } else {
      buffer.bytesused = static_cast<__u32>(frame.bytes.size());
    }
    return 0;
  }

  FakeDevice& device_;
  std::size_t length_ = 0;  ///< of a buffer
};

/// A machine with scripted cameras and a clock that tests turn.
class FakeVideoSystem final : public VideoSystem {
 public:
  std::vector<FakeDevice> cameras{FakeDevice{}};
  Stamp time{std::chrono::seconds(1000)};
  std::optional<Error> cannot_open;

  [[nodiscard]] std::vector<VideoDevice> nodes() override {
    std::vector<VideoDevice> all;
    for (const FakeDevice& camera : cameras) {
      const VideoDevice& known = camera.identity;
      // Of others than USB's only the opened device tells it.
      const std::string bus = known.bus.starts_with("usb-") ? known.bus : "";
      if (!camera.gone) all.push_back({known.node, known.links, bus, known.serial, ""});
    }
    return all;
  }
  [[nodiscard]] Expected<std::unique_ptr<VideoNode>> open(const std::string& node) override {
    if (cannot_open) return tl::make_unexpected(*cannot_open);
    for (FakeDevice& camera : cameras) {
      if (camera.identity.node == node) return std::make_unique<FakeVideoNode>(camera);
    }
    return fail(ErrorKind::unavailable, "{}: absent", node);
  }
  [[nodiscard]] Stamp now() const override { return time; }
};

}  // namespace waymark::test
