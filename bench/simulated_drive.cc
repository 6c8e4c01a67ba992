#include "bench/simulated_drive.h"

#include <algorithm>
#include <cmath>

#include "core/estimate/calibration_prior.h"

namespace waymark::bench {
namespace {

constexpr Stamp kStart = std::chrono::seconds(1'000'000);

Stamp to_stamp(double seconds) { return kStart + Stamp(std::llround(seconds * 1e9)); }

}  // namespace

SimulatedDrive::SimulatedDrive(const simulator::Scene& building, const Rig& rig,
                               const DriveOptions& options)
    : rig_(rig),
      cam0_from_rig_(rig.cameras.front().rig_from_cam.inverse()),
      noise_px_(options.noise_px),
      options_(options),
      way_(building.trajectory),
      random_(options.seed),
      images_(rig.cameras.size()) {
  rebuild(building);
}

void SimulatedDrive::rebuild(const simulator::Scene& building) {
  visibility_.reset();
  building_ = building;
  visibility_.emplace(building_);
}

Rigid3 SimulatedDrive::world_from_rig(Stamp stamp) const {
  const double time_s = in_s(stamp - kStart);
  return way_.world_from_cam0(options_.start_m + time_s * options_.speed_mps) * cam0_from_rig_;
}

Rigid3 SimulatedDrive::world_from_rig_at_set(int set) const {
  return world_from_rig(to_stamp(set * options_.period_s));
}

double SimulatedDrive::turn_rate(Stamp stamp) const {
  constexpr Stamp kStep = std::chrono::milliseconds(10);
  return angle_between_rad(world_from_rig(stamp - kStep).rotation,
                           world_from_rig(stamp + kStep).rotation) /
         0.02;
}

MarkerId SimulatedDrive::misread(const MarkerId& truth) {
  for (;;) {
    MarkerId read = building_.markers[random_.below(building_.markers.size())].id;
    if (random_.uniform() < 0.5) {
      read.number =
          static_cast<int>(random_.below(static_cast<std::uint64_t>(traits(read.family).id_count)));
    }
    if (read != truth) return read;
  }
}

void SimulatedDrive::roll(std::size_t camera, Stamp middle, const simulator::PlacedMarker& marker,
                          ImageCorners& corners) const {
  if (options_.readout_s == 0) return;
  const CameraModel& model = rig_.cameras[camera].model;
  const double rows = model.parameters().height_px;
  const auto in_marker = marker_corners(marker.size_m);
  for (std::size_t i = 0; i < 4; ++i) {
    for (int round = 0; round < 3; ++round) {
      const double after_s = options_.readout_s * (corners[i].y() - 0.5 * (rows - 1)) / rows;
      const Rigid3 world_from_cam = world_from_rig(middle + Stamp(std::llround(after_s * 1e9))) *
                                    rig_.cameras[camera].rig_from_cam;
      const auto pixel =
          model.project(world_from_cam.inverse() * (marker.world_from_marker * in_marker[i]));
      if (pixel) corners[i] = *pixel;
    }
  }
}

FrameSetLease SimulatedDrive::next() {
  FrameSetLease set;
  set.sequence = sets_;
  visible_.clear();
  const double time_s = static_cast<double>(sets_++) * options_.period_s;
  for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
    set.expected |= camera_bit(c);
    ImageDetections& image = images_[c];
    image.detections.clear();
    image.camera = static_cast<int>(c);
    image.stamp = to_stamp(time_s + (c < 3 ? options_.offset_s[c] : 0));
    if (random_.uniform() < options_.drop_out_rate) continue;
    const Stamp exposed = image.stamp - Stamp(std::llround((c < 3 ? options_.late_s[c] : 0) * 1e9));
    const Rigid3 world_from_cam = world_from_rig(exposed) * rig_.cameras[c].rig_from_cam;
    for (const auto& seen : visibility_->visible_from(rig_.cameras[c].model, world_from_cam)) {
      if (random_.uniform() < options_.miss_rate) continue;
      visible_.push_back(seen.marker);
      Detection detection;
      detection.marker = building_.markers[seen.marker].id;
      if (random_.uniform() < options_.false_rate) detection.marker = misread(detection.marker);
      detection.corners = seen.corners;
      roll(c, exposed, building_.markers[seen.marker], detection.corners);
      for (Eigen::Vector2d& corner : detection.corners) {
        corner += noise_px_ * Eigen::Vector2d(random_.normal(), random_.normal());
      }
      detection.covariances.emplace();
      detection.covariances->fill(options_.noise_px * options_.noise_px *
                                  Eigen::Matrix2d::Identity());
      image.detections.push_back(detection);
    }
    set.cameras |= camera_bit(c);
    FrameInfo info;
    info.stamp = image.stamp;
    info.arrival = image.stamp;
    info.sequence = set.sequence;
    info.quality = StampQuality::replayed;
    set.frames[c] = Frame(info, {}, &image, nullptr, 0);
  }
  return set;
}

MarkerMap true_map(const simulator::Scene& scene) {
  MarkerMap map;
  SubMap& submap = map.submaps.emplace_back();
  for (const simulator::PlacedMarker& placed : scene.markers) {
    MapMarker marker;
    marker.id = placed.id;
    marker.size_m = placed.size_m;
    marker.stated_size_m = placed.size_m;
    marker.world_from_marker = placed.world_from_marker;
    marker.verified = true;
    submap.markers.push_back(marker);
  }
  state_exact_sizes(submap);
  return map;
}

}  // namespace waymark::bench
