#include "mapbuilder/import/lcm_detections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <waymark/detections_t.hpp>

#include "core/base/text_field.h"
#include "mapbuilder/import/byte_cursor.h"
#include "mapbuilder/import/lcm_log.h"

namespace waymark {
namespace {

constexpr std::size_t kMostCameras = 64;
constexpr double kMaxCorner_px = 1e6;
/// No two frames of one set are further apart (kSyncTolerance_us).
constexpr double kMaxOffset_us = 1e6;
constexpr std::int64_t kMaxUtime_us = std::numeric_limits<std::int64_t>::max() / 2000;

tl::unexpected<Error> broken(std::string_view why) {
  return fail(ErrorKind::bad_data, "damaged message of detections: {}", why);
}

/// Whether three numbers are a covariance; one that float has rounded to the edge of being none is
/// drawn back.
std::optional<Eigen::Matrix2d> covariance_of(double xx, double xy, double yy) {
  constexpr double kRounding = 1e-6;
  if (!(std::isfinite(xx) && std::isfinite(yy) && xx > 0 && yy > 0)) return std::nullopt;
  const double most = std::sqrt(xx * yy);
  if (!(std::abs(xy) <= most * (1 + kRounding))) return std::nullopt;
  xy = std::clamp(xy, -most * (1 - kRounding), most * (1 - kRounding));
  return (Eigen::Matrix2d() << xx, xy, xy, yy).finished();
}

/// Reads a message from its front; the fields' order is that of proto/detections_t.lcm.
class MessageReader {
 public:
  explicit MessageReader(std::span<const std::uint8_t> message) : in_(message, std::endian::big) {}

  Expected<LoggedSet> read() {
    (void)in_.number<std::int64_t>();  // the hash
    utime_us_ = in_.number<std::int64_t>();
    set_.sequence = in_.number<std::int64_t>();
    set_.session = text();
    set_.rig_fingerprint = text();
    if (auto cameras = read_cameras(); !cameras) return tl::make_unexpected(cameras.error());
    if (auto markers = read_markers(); !markers) return tl::make_unexpected(markers.error());
    if (in_.failed() || in_.left() > 0) return broken("it has another length than it states");
    std::erase_if(set_.images, [](const ImageDetections& image) { return image.camera < 0; });
    return std::move(set_);
  }

 private:
  /// LCM's texts: their length, which counts a 0 at the end.
  std::string text() {
    const auto size = in_.number<std::int32_t>();
    if (size <= 0) return {};
    const std::string_view whole = in_.text(static_cast<std::size_t>(size));
    return std::string(whole.substr(0, whole.find('\0')));
  }

  /// An image per camera; of camera −1 where it gave none.
  Status read_cameras() {
    const auto count = in_.number<std::int32_t>();
    if (count < 1 || static_cast<std::size_t>(count) > kMostCameras) {
      return broken(fmt::format("{} cameras", count));
    }
    if (std::abs(utime_us_) > kMaxUtime_us) return broken("its time is none");
    set_.cameras = static_cast<std::size_t>(count);
    for (int camera = 0; camera < count; ++camera) {
      const auto offset_us = in_.number<double>();
      if (std::abs(offset_us) > kMaxOffset_us) return broken("frames that are no set");
      ImageDetections& image = set_.images.emplace_back();
      image.camera = std::isnan(offset_us) ? -1 : camera;
      const std::int64_t offset_ns = image.camera < 0 ? 0 : std::llround(offset_us * 1e3);
      image.stamp = Stamp(1000 * utime_us_ + offset_ns);
    }
    return {};
  }

  Status read_markers() {
    // Camera, a family's length, number, corners, covariances, verdict.
    constexpr std::size_t kLeast = 4 + 4 + 4 + 8 * 4 + 12 * 4 + 1;
    const auto stated = in_.number<std::int32_t>();
    if (stated < 0 || static_cast<std::size_t>(stated) > in_.left() / kLeast) {
      return broken(fmt::format("{} markers in {} bytes", stated, in_.left()));
    }
    const auto count = static_cast<std::size_t>(stated);
    std::vector<std::int32_t> cameras(count);
    for (std::int32_t& camera : cameras) camera = in_.number<std::int32_t>();
    std::vector<Detection> markers(count);
    if (auto named = read_names(markers); !named) return named;
    for (Detection& marker : markers) {
      if (auto corners = read_corners(marker); !corners) return corners;
    }
    for (Detection& marker : markers) {
      if (auto covariances = read_covariances(marker); !covariances) return covariances;
    }
    (void)in_.bytes(count);  // verdicts: what locd thought of them is no part of a capture
    for (std::size_t i = 0; i < count; ++i) {
      const bool known = cameras[i] >= 0 && static_cast<std::size_t>(cameras[i]) < set_.cameras;
      if (!known || set_.images[static_cast<std::size_t>(cameras[i])].camera < 0) {
        return broken(fmt::format("a marker of camera {}, which gave no frame", cameras[i]));
      }
      set_.images[static_cast<std::size_t>(cameras[i])].detections.push_back(markers[i]);
    }
    return {};
  }

  Status read_names(std::vector<Detection>& markers) {
    for (Detection& marker : markers) {
      const std::string name = text();
      const auto family = family_from_name(name);
      if (!family) return broken(fmt::format("\"{}\" is no family", name));
      marker.marker.family = *family;
    }
    for (Detection& marker : markers) {
      marker.marker.number = in_.number<std::int32_t>();
      if (marker.marker.number >= 0 &&
          marker.marker.number < traits(marker.marker.family).id_count) {
        continue;
      }
      return broken(
          fmt::format("{} has no {}", name_of(marker.marker.family), marker.marker.number));
    }
    return {};
  }

  Status read_corners(Detection& marker) {
    for (Eigen::Vector2d& corner : marker.corners) {
      for (double& value_px : corner) {
        value_px = in_.number<float>();
        if (!(std::abs(value_px) <= kMaxCorner_px)) return broken("a corner that is no pixel");
      }
    }
    return {};
  }

  Status read_covariances(Detection& marker) {
    std::array<double, 12> values{};
    for (double& value : values) value = in_.number<float>();
    if (std::all_of(values.begin(), values.end(), [](double v) { return std::isnan(v); }))
      return {};
    CornerCovariances& covariances = marker.covariances.emplace();
    for (std::size_t k = 0; k < covariances.size(); ++k) {
      const auto one = covariance_of(values[3 * k], values[3 * k + 1], values[3 * k + 2]);
      if (!one) return broken("a covariance that is none");
      covariances[k] = *one;
    }
    return {};
  }

  ByteCursor in_;
  std::int64_t utime_us_ = 0;
  LoggedSet set_;
};

/// The same type of message by its channel's name, as every version of locd calls it.
bool is_named_detections(const std::string& channel) { return channel.ends_with("_DETECTIONS"); }

/// Gathers the sets of one channel.
class Gatherer {
 public:
  Gatherer(std::string log, std::string channel) : log_(std::move(log)), chosen_(!channel.empty()) {
    all_.channel = std::move(channel);
  }

  Status take(const LcmEvent& event) {
    if (!is_detections_message(event.data)) {
      other_version_ = other_version_ || is_named_detections(event.channel);
      return {};
    }
    if (all_.channel.empty()) all_.channel = event.channel;
    if (event.channel != all_.channel) {
      if (chosen_) return {};
      return fail(ErrorKind::bad_data,
                  "{}: detections on {} and on {}, of two vehicles or programs; choose one by "
                  "--channel",
                  log_, all_.channel, event.channel);
    }
    auto set = decode_detections(event.data);
    if (!set) return fail(ErrorKind::bad_data, "{}: {}", log_, set.error().message);
    return add(std::move(*set));
  }

  Expected<LoggedDetections> finish() {
    if (all_.frame_sets == 0) return tl::make_unexpected(none());
    std::stable_sort(all_.images.begin(), all_.images.end(), by_time);
    const auto twice = std::adjacent_find(
        all_.images.begin(), all_.images.end(),
        [](const auto& a, const auto& b) { return a.stamp == b.stamp && a.camera == b.camera; });
    if (twice != all_.images.end()) {
      return fail(ErrorKind::bad_data, "{}: two images of cam{} at {} ns; is it two logs in one?",
                  log_, twice->camera, twice->stamp.count());
    }
    return std::move(all_);
  }

 private:
  static bool by_time(const ImageDetections& a, const ImageDetections& b) {
    return std::tie(a.stamp, a.camera) < std::tie(b.stamp, b.camera);
  }

  Status add(LoggedSet set) {
    if (all_.frame_sets > 0 && set.session == last_session_ && set.sequence == last_sequence_) {
      return {};  // the network gave it twice
    }
    if (all_.frame_sets == 0) {
      all_.session = set.session;
      all_.rig_fingerprint = set.rig_fingerprint;
      all_.cameras = set.cameras;
    }
    if (set.rig_fingerprint != all_.rig_fingerprint || set.cameras != all_.cameras) {
      return fail(ErrorKind::bad_data,
                  "{}: the rig file changed on the way ({}, then {}); a capture has one rig: log "
                  "each alone",
                  log_, all_.rig_fingerprint, set.rig_fingerprint);
    }
    last_session_ = std::move(set.session);
    last_sequence_ = set.sequence;
    ++all_.frame_sets;
    widen_tolerance(set.images);
    std::move(set.images.begin(), set.images.end(), std::back_inserter(all_.images));
    return {};
  }

  void widen_tolerance(const std::vector<ImageDetections>& images) {
    if (images.empty()) return;
    const auto [first, last] =
        std::minmax_element(images.begin(), images.end(),
                            [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
    constexpr Stamp kRounding = std::chrono::microseconds(1);
    constexpr Stamp kMost = std::chrono::microseconds(static_cast<int>(kSyncTolerance_us.high));
    const Stamp skew = std::min(last->stamp - first->stamp + kRounding, kMost);
    all_.sync_tolerance = std::max(all_.sync_tolerance, skew);
  }

  [[nodiscard]] Error none() const {
    if (other_version_) {
      return {
          ErrorKind::bad_data,
          fmt::format("{}: its detections are of another version of Waymark; import it with the "
                      "mapbuilder that came with that locd",
                      log_)};
    }
    return {ErrorKind::bad_data,
            fmt::format("{}: no message of detections in it; locd sends them with [lcm] detections "
                        "= true, and lcm-logger writes them",
                        log_)};
  }

  std::string log_;
  LoggedDetections all_;
  bool chosen_ = false;
  bool other_version_ = false;
  std::string last_session_;
  std::int64_t last_sequence_ = 0;
};

}  // namespace

bool is_detections_message(std::span<const std::uint8_t> message) {
  ByteCursor in(message, std::endian::big);
  return in.number<std::int64_t>() == detections_t::getHash() && !in.failed();
}

Expected<LoggedSet> decode_detections(std::span<const std::uint8_t> message) {
  if (!is_detections_message(message)) return broken("it is none");
  return MessageReader(message).read();
}

Expected<LoggedDetections> read_lcm_detections(const std::filesystem::path& path,
                                               const std::string& channel, Progress& progress) {
  auto log = LcmLog::open(path);
  if (!log) return tl::make_unexpected(log.error());
  Gatherer gatherer(path.string(), channel);
  constexpr std::uintmax_t kMegabyte = 1'000'000;
  progress.begin("reading the log, MB", log->size() / kMegabyte);
  for (;;) {
    const auto event = log->next();
    if (!event) return tl::make_unexpected(event.error());
    if (!*event) break;
    if (auto taken = gatherer.take(**event); !taken) return tl::make_unexpected(taken.error());
    progress.update(log->position() / kMegabyte);
  }
  progress.end();
  return gatherer.finish();
}

}  // namespace waymark
