#pragma once

#include "core/map/marker_map.h"

namespace waymark::test {

/// Two sub-maps of three and two markers of one family, every field with a value of its own.
inline MarkerMap small_map() {
  const auto marker = [](int number, const Eigen::Vector3d& position, const Eigen::Vector3d& turn) {
    MapMarker m;
    m.id = {Family::tag36h11, number};
    m.stated_size_m = 0.12;
    m.size_m = 0.12;
    m.world_from_marker = {so3_exp(turn), position};
    m.covariance.diagonal() << 1e-6, 2e-6, 3e-6, 4e-7, 5e-7, 6e-7;
    m.covariance(0, 4) = m.covariance(4, 0) = -2.5e-7;
    m.observations = 10 + static_cast<std::uint32_t>(number);
    m.rejected = 1;
    m.rms_px = 0.25;
    m.verified = true;
    return m;
  };
  MarkerMap map;
  map.builder_version = "0.1.0";
  map.rig_fingerprint = "0123456789abcdef";
  map.capture_fingerprints = {"00000000000000aa", "00000000000000bb"};
  SubMap first;
  first.frame = FrameKind::scaled;
  first.markers = {marker(3, {0, 0, 0}, {0, 0, 0}),
                   marker(12, {1.5, -0.25, 0.125}, {0.5, 0.25, -1}),
                   marker(586, {4, 2, 1}, {0, 3, 0})};
  first.markers[1].size_m = 0.121;
  first.markers[2].verified = false;
  first.frame_sets = 42;
  first.rms_px = 0.3125;
  first.rms_all_px = 0.5;
  SubMap second;
  second.markers = {marker(0, {0, 0, 0}, {1, 0, 0}), marker(7, {0, 1, 0}, {0, 1, 0})};
  second.frame_sets = 5;
  second.rms_px = 0.25;
  second.rms_all_px = 0.25;
  map.submaps = {first, second};
  return map;
}

/// The same, considering two parameters in its first sub-map and none in the second.
inline MarkerMap considered_small_map() {
  MarkerMap map = small_map();
  SubMap& first = map.submaps[0];
  first.parameters = {{"cam0 focal length", "00417", {}}, {"size 0.12 m", "", {}}};
  first.parameters[0].cross.setConstant(0.0625e-3);
  first.parameters[1].cross.setZero();
  first.parameter_covariance = Eigen::Matrix2d{{1e-6, 2.5e-7}, {2.5e-7, 4e-6}};
  for (SubMap& submap : map.submaps) {
    for (MapMarker& marker : submap.markers) {
      // What a file holds in floats.
      marker.covariance = marker.covariance.cast<float>().cast<double>();
    }
  }
  for (MapMarker& marker : first.markers) {
    marker.modes(0, 0) = 0.001953125F;
    marker.modes(5, 15) = -0.0009765625F;
    const Eigen::Matrix<double, 6, kMapModes> modes = marker.modes.cast<double>();
    marker.covariance_metric = marker.covariance + modes * modes.transpose();
  }
  return map;
}

}  // namespace waymark::test
