#include "locd/frames/image_health.h"

#include <xxhash.h>

#include <algorithm>
#include <cstdlib>

#include "core/base/check.h"

namespace waymark {
namespace {

enum FaultIndex : std::size_t { kFrozen, kStale, kDark, kSaturated, kObscured };
constexpr std::array kKinds = {AlertKind::image_frozen, AlertKind::image_stale,
                               AlertKind::image_dark, AlertKind::image_saturated,
                               AlertKind::image_obscured};

/// Counts of grey levels, and of differences across 4 px.
struct Histograms {
  std::array<int, 256> grey{};
  std::array<int, 256> edge{};
  int pixels = 0;
  int edges = 0;
};

Histograms sample(const GrayView& image) {
  constexpr int kStep = 4;
  Histograms histograms;
  for (int y = 0; y < image.height_px; y += kStep) {
    const std::uint8_t* row = image.row(y);
    for (int x = 0; x < image.width_px; x += kStep) {
      ++histograms.grey[row[x]];
      ++histograms.pixels;
      if (x < kStep) continue;
      ++histograms.edge[static_cast<std::size_t>(std::abs(row[x] - row[x - kStep]))];
      ++histograms.edges;
    }
  }
  return histograms;
}

/// Share of the counts at `level` and above.
double share_from(const std::array<int, 256>& counts, int total, int level) {
  int sum = 0;
  for (int i = level; i < 256; ++i) sum += counts[static_cast<std::size_t>(i)];
  return total == 0 ? 0.0 : static_cast<double>(sum) / total;
}

std::uint64_t hash_of(const GrayView& image) {
  std::uint64_t hash = 0;
  for (int y = 0; y < image.height_px; ++y) {
    hash = XXH3_64bits_withSeed(image.row(y), static_cast<std::size_t>(image.width_px), hash);
  }
  return hash;
}

std::uint64_t hash_of(std::span<const Detection> detections) {
  std::uint64_t hash = 0;
  for (const Detection& detection : detections) {
    std::array<double, 10> content{};
    content[0] = static_cast<double>(detection.marker.family);
    content[1] = detection.marker.number;
    for (std::size_t i = 0; i < 4; ++i) {
      content[2 + 2 * i] = detection.corners[i].x();
      content[3 + 2 * i] = detection.corners[i].y();
    }
    hash = XXH3_64bits_withSeed(content.data(), sizeof content, hash);
  }
  return hash;
}

}  // namespace

Status ImageHealthOptions::check() const {
  return RangeCheck()
      .field("identical_images", identical_images, {2, 100})
      .field("dark_grey", dark_grey, {1, 100})
      .field("bright_grey", bright_grey, {100, 255})
      .field("saturated_share", saturated_share, {0.1, 1})
      .field("edge_grey", edge_grey, {1, 50})
      .field("sets_to_raise", sets_to_raise, {1, 100})
      .field("sets_to_clear", sets_to_clear, {1, 100})
      .status();
}

ImageHealth::ImageHealth(std::size_t cameras, const ImageHealthOptions& options)
    : options_(options), cameras_(cameras) {
  WAYMARK_CHECK(options.check().has_value());
}

CameraMask ImageHealth::look(const FrameSetLease& set, std::vector<Alert>& alerts) {
  for (std::size_t c = 0; c < cameras_.size(); ++c) {
    if (!set.has(c)) continue;
    const Frame& frame = set.frames[c];
    if (frame.has_image()) {
      look(c, frame.image(), frame.stamp(), alerts);
    } else if (frame.detections() != nullptr) {
      look(c, frame.detections()->detections, frame.stamp(), alerts);
    }
  }
  return set.cameras & ~unhealthy() & ~repeated();
}

void ImageHealth::look(std::size_t camera, const GrayView& image, Stamp stamp,
                       std::vector<Alert>& alerts) {
  compare(camera, hash_of(image), stamp, alerts);
  const Histograms h = sample(image);
  const bool dark = share_from(h.grey, h.pixels, options_.dark_grey) < 0.01;
  const bool saturated =
      share_from(h.grey, h.pixels, options_.bright_grey) > options_.saturated_share;
  const bool flat = share_from(h.edge, h.edges, options_.edge_grey) < 0.005;
  note(camera, kDark, dark, options_.sets_to_raise, stamp, alerts);
  note(camera, kSaturated, saturated, options_.sets_to_raise, stamp, alerts);
  note(camera, kObscured, flat && !dark && !saturated, options_.sets_to_raise, stamp, alerts);
  sum_up(camera);
}

void ImageHealth::look(std::size_t camera, std::span<const Detection> detections, Stamp stamp,
                       std::vector<Alert>& alerts) {
  if (detections.empty()) {
    repeated_ &= ~camera_bit(camera);
    return;
  }
  compare(camera, hash_of(detections), stamp, alerts);
  sum_up(camera);
}

void ImageHealth::compare(std::size_t camera, std::uint64_t hash, Stamp stamp,
                          std::vector<Alert>& alerts) {
  Images& images = cameras_[camera].images;
  const auto known =
      images.hashes.begin() + static_cast<std::ptrdiff_t>(std::min(images.different, kRemembered));
  const bool repeats = std::find(images.hashes.begin(), known, hash) != known;
  const bool doubted = options_.doubt_first_images && images.different == 0;
  const bool as_last = images.different > 0 && hash == images.last_hash;
  images.identical = as_last ? images.identical + 1 : 1;
  // One that equals the last says nothing new of whether old images come again.
  if (!as_last) images.older = repeats ? images.older + 1 : 0;
  images.last_hash = hash;
  if (!repeats) images.hashes[images.different++ % kRemembered] = hash;
  repeated_ = repeats || doubted ? repeated_ | camera_bit(camera) : repeated_ & ~camera_bit(camera);
  note(camera, kFrozen, images.identical >= options_.identical_images, 1, stamp, alerts);
  note(camera, kStale, images.older >= options_.identical_images, 1, stamp, alerts);
}

void ImageHealth::remember_images_of(const ImageHealth& before) {
  const std::size_t same = std::min(cameras_.size(), before.cameras_.size());
  for (std::size_t c = 0; c < same; ++c) cameras_[c].images = before.cameras_[c].images;
}

void ImageHealth::sum_up(std::size_t camera) {
  const auto& faults = cameras_[camera].faults;
  const bool any =
      std::any_of(faults.begin(), faults.end(), [](const Fault& fault) { return fault.raised; });
  unhealthy_ = any ? unhealthy_ | camera_bit(camera) : unhealthy_ & ~camera_bit(camera);
}

void ImageHealth::note(std::size_t camera, std::size_t index, bool present, int sets_to_raise,
                       Stamp stamp, std::vector<Alert>& alerts) {
  Fault& fault = cameras_[camera].faults[index];
  fault.sets = present ? fault.sets + 1 : 0;
  fault.healthy = present ? 0 : fault.healthy + 1;
  const bool raise = !fault.raised && fault.sets >= sets_to_raise;
  const bool clear = fault.raised && fault.healthy >= options_.sets_to_clear;
  if (!raise && !clear) return;
  fault.raised = raise;
  Alert alert;
  alert.kind = kKinds[index];
  alert.raised = raise;
  alert.stamp = stamp;
  alert.camera = static_cast<int>(camera);
  alerts.push_back(alert);
}

}  // namespace waymark
