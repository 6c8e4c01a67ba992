#include "mapbuilder/build/submap_residuals.h"

#include <algorithm>
#include <map>

namespace waymark {

void ResidualSum::add(const std::array<Eigen::Vector2d, 4>& residuals, double most_px) {
  for (const Eigen::Vector2d& r : residuals) {
    squared_px2 += std::min(r.squaredNorm(), most_px * most_px);
  }
  corners += 4;
}

namespace {

/// Whether two observations show a marker by one camera at one place of the image: nothing moved
/// between them.
bool are_one_view(const Observation& a, const Observation& b) {
  constexpr double kStands_px = 2.0;
  if (a.camera != b.camera) return false;
  for (std::size_t i = 0; i < 4; ++i) {
    if ((a.corners_px[i] - b.corners_px[i]).norm() > kStands_px) return false;
  }
  return true;
}

/// Counts an accepted view by a rig that other markers place as well.
void count_independent(const Observations& all, ObservationIndex index, MarkerResiduals& marker) {
  if (!marker.first_independent) {
    marker.first_independent = index;
    marker.independent = 1;
  } else if (!are_one_view(all[*marker.first_independent], all[index])) {
    ++marker.independent;
  }
}

}  // namespace

SubMapResiduals residuals_of(const PreparedObservations& prepared, const Estimate& estimate,
                             std::span<const ObservationIndex> observations) {
  const Observations& all = prepared.observations();
  std::map<FrameSetIndex, int> accepted_in_set;
  for (const ObservationIndex index : observations) {
    accepted_in_set[all[index].frame_set] += estimate.accepted[index];
  }
  SubMapResiduals result;
  result.of_marker.resize(all.markers.size());
  for (const ObservationIndex index : observations) {
    const Observation& o = all[index];
    const CameraModel& camera = estimate.calibration.camera(all, o).model;
    const auto residuals =
        corner_residuals(prepared[index], camera, cam_from_marker(all, estimate, o));
    const double most_px = gross_residual_px(camera);
    MarkerResiduals& of_marker = result.of_marker[o.marker];
    if (residuals) {
      result.all.add(*residuals, most_px);
      result.each.push_back({index, estimate.accepts(index), *residuals});
    }
    if (!estimate.accepts(index) || !residuals) {
      ++of_marker.rejected;
      ++result.rejected;
      continue;
    }
    ++of_marker.accepted;
    if (accepted_in_set[o.frame_set] >= 2) count_independent(all, index, of_marker);
    result.inliers.add(*residuals, most_px);
    of_marker.inliers.add(*residuals, most_px);
  }
  return result;
}

}  // namespace waymark
