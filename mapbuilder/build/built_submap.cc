#include "mapbuilder/build/built_submap.h"

#include <algorithm>

#include "mapbuilder/bundle/marker_covariances.h"
#include "mapbuilder/calibration/scale_bound.h"
#include "mapbuilder/observations/covisibility.h"

namespace waymark {
namespace {

/// Makes one sub-map, decision by decision.
class SubMapMaker {
 public:
  SubMapMaker(const IncrementalMapper& mapper, const CalibratedEstimate& calibrated,
              const BuildOptions& options, const Component& component)
      : mapper_(mapper),
        observations_(mapper.selection().observations()),
        prepared_(mapper.prepared(calibrated.estimate, PreparedObservations::Ippe::none)),
        estimate_(calibrated.estimate),
        scope_(calibrated.system.scope),
        options_(options),
        component_(component),
        in_facility_(stands_in_facility(observations_, calibrated, component)),
        seed_(choose_seed(mapper.selection(), component)) {
    for (const ObservationIndex index : mapper.selection().used_in(component.frame_sets)) {
      if (estimate_.posed(observations_[index])) posed_.push_back(index);
    }
    if (!in_facility_) {
      world_from_built_ = estimate_.world_from_rig[seed_]->best.pose.inverse();
      // What the gate has cut off stands in no world but its own.
      scope_.world_of_marker = {};
    }
  }

  [[nodiscard]] BuiltSubMap make() {
    take_fit();
    take_residuals();
    take_frame();
    take_trajectory();
    take_markers();
    return std::move(made_);
  }

 private:
  /// Noise and rest of the grown components that the sub-map has markers of.
  void take_fit() {
    made_.converged = true;
    for (const ComponentIndex c : mapper_.selection().components().indices()) {
      const auto& grown = mapper_.component(c).markers;
      const bool here = std::any_of(
          component_.markers.begin(), component_.markers.end(),
          [&](MarkerIndex m) { return std::binary_search(grown.begin(), grown.end(), m); });
      if (!here) continue;
      const ComponentEstimate& fit = estimate_.components[c];
      made_.model_sigma_px = std::max(made_.model_sigma_px, fit.noise.model_sigma_px);
      made_.converged = made_.converged && fit.converged;
    }
  }

  void take_residuals() {
    SubMapResiduals residuals = residuals_of(prepared_, estimate_, posed_);
    made_.observations = posed_.size();
    made_.rejected = residuals.rejected;
    made_.residuals = std::move(residuals.each);
    made_.map.rms_px = residuals.inliers.rms_px();
    made_.map.rms_all_px = residuals.all.rms_px();
    of_marker_ = std::move(residuals.of_marker);
  }

  /// What kind of world the sub-map stands in, and how well its scale is known.
  void take_frame() {
    const MarkerPoses poses = poses_of(component_, estimate_);
    if (in_facility_) {
      made_.map.frame = FrameKind::facility;
      made_.map.z_is_up = true;
    } else if (scope_.survey != nullptr &&
               reach_of(*scope_.survey, observations_, estimate_.calibration, poses).scale) {
      made_.map.frame = FrameKind::scaled;
    }
    if (made_.map.frame == FrameKind::arbitrary) {
      made_.scale_per_edge_px = scale_per_edge_px(prepared_, estimate_, posed_, seed_,
                                                  options_.loss, mapper_.options().threads);
    }
    made_.survey = survey_residuals(options_.survey, observations_, estimate_.calibration, poses,
                                    in_facility_);
  }

  void take_trajectory() {
    for (const FrameSetIndex frame_set : component_.frame_sets) {
      const RigPoseEstimate& rig = *estimate_.world_from_rig[frame_set];
      if (rig.ambiguous) {
        made_.ambiguous.push_back(frame_set);
      } else {
        made_.trajectory.push_back({frame_set, world_from_built_ * rig.best.pose});
      }
    }
    made_.map.frame_sets = static_cast<std::uint32_t>(made_.trajectory.size());
  }

  void take_markers() {
    BundleProblem problem;
    problem.prepared = &prepared_;
    problem.observations = posed_;
    problem.scope = scope_;
    problem.loss = options_.loss;
    const MarkerInformation information =
        marker_information(problem, estimate_, mapper_.options().threads);
    const std::vector<Matrix6d> covariances = marker_covariances(information);
    made_.covariances_known = !covariances.empty();
    for (const MarkerIndex m : component_.markers) {
      MapMarker marker = marker_of(m);
      const auto slot = std::lower_bound(information.markers.begin(), information.markers.end(), m);
      if (!covariances.empty() && slot != information.markers.end() && *slot == m) {
        marker.covariance =
            turned(covariances[static_cast<std::size_t>(slot - information.markers.begin())]);
      }
      made_.map.markers.push_back(marker);
    }
  }

  /// All but a known covariance.
  [[nodiscard]] MapMarker marker_of(MarkerIndex m) const {
    const MarkerResiduals& residuals = of_marker_[m];
    MapMarker marker;
    marker.id = observations_.markers[m];
    marker.stated_size_m = observations_.stated_sizes_m[m];
    marker.size_m = estimate_.calibration.sizes_m[m];
    marker.world_from_marker = world_from_built_ * *estimate_.world_from_marker[m];
    marker.observations = residuals.accepted;
    marker.rejected = residuals.rejected;
    marker.rms_px = residuals.inliers.rms_px();
    marker.verified = residuals.independent >= 2;
    marker.covariance = unknown_covariance();
    return marker;
  }

  [[nodiscard]] Matrix6d turned(const Matrix6d& covariance) const {
    const Matrix6d turn = left_motion_jacobian(world_from_built_);
    const Matrix6d result = turn * covariance * turn.transpose();
    return 0.5 * (result + result.transpose());
  }

  const IncrementalMapper& mapper_;
  const Observations& observations_;
  const PreparedObservations& prepared_;
  const Estimate& estimate_;
  BundleScope scope_;
  const BuildOptions& options_;
  const Component& component_;
  bool in_facility_;
  FrameSetIndex seed_;
  Rigid3 world_from_built_;
  std::vector<ObservationIndex> posed_;
  IndexedVector<MarkerIndex, MarkerResiduals> of_marker_;
  BuiltSubMap made_;
};

}  // namespace

bool stands_in_facility(const Observations& observations, const CalibratedEstimate& calibrated,
                        const Component& component) {
  const BundleScope& scope = calibrated.system.scope;
  const Estimate& estimate = calibrated.estimate;
  return scope.survey != nullptr && scope.in_facility(component.markers.front()) &&
         reach_of(*scope.survey, observations, estimate.calibration, poses_of(component, estimate))
             .frame;
}

BuiltSubMap built_submap_of(const IncrementalMapper& mapper, const CalibratedEstimate& calibrated,
                            const BuildOptions& options, const Component& component) {
  return SubMapMaker(mapper, calibrated, options, component).make();
}

}  // namespace waymark
