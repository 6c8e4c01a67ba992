#include "mapbuilder/build/built_submap.h"

#include <algorithm>

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
    const auto considered = considered_map(problem, estimate_, mapper_.options().threads);
    made_.covariances_known = considered.has_value();
    for (const MarkerIndex m : component_.markers) made_.map.markers.push_back(marker_of(m));
    if (considered) take_considered(*considered);
    for (MapMarker& marker : made_.map.markers) move_marker(world_from_built_, marker);
  }

  void take_considered(const ConsideredMap& considered) {
    made_.scale = considered.scale;
    made_.noise_share = considered.noise_share;
    made_.dropped_mean = considered.dropped_mean;
    made_.dropped_worst = considered.dropped_worst;
    for (std::size_t i = 0; i < considered.markers.size(); ++i) {
      const auto at = std::lower_bound(component_.markers.begin(), component_.markers.end(),
                                       considered.markers[i]);
      if (at == component_.markers.end() || *at != considered.markers[i]) continue;
      MapMarker& marker =
          made_.map.markers[static_cast<std::size_t>(at - component_.markers.begin())];
      marker.covariance = considered.of_marker[i].within;
      marker.covariance_metric = considered.of_marker[i].metric;
      marker.modes = considered.of_marker[i].modes;
    }
    for (std::size_t i = 0; i < considered.parameters.all.size(); ++i) {
      const ConsiderParameter& one = considered.parameters.all[i];
      MapParameter& parameter = made_.map.parameters.emplace_back();
      parameter.name = name_of(one, considered.rigs);
      if (!one.is_size()) {
        parameter.serial =
            considered.rigs[one.rig].cameras[one.of_rig.camera].serial.substr(0, kMaxSerialText);
      }
      parameter.cross = considered.cross.row(static_cast<Eigen::Index>(i));
    }
    made_.map.parameter_covariance = considered.parameters.covariance;
  }

  /// All but a known covariance, in the estimate's world.
  [[nodiscard]] MapMarker marker_of(MarkerIndex m) const {
    const MarkerResiduals& residuals = of_marker_[m];
    MapMarker marker;
    marker.id = observations_.markers[m];
    marker.stated_size_m = observations_.stated_sizes_m[m];
    marker.size_m = estimate_.calibration.sizes_m[m];
    marker.world_from_marker = *estimate_.world_from_marker[m];
    marker.observations = residuals.accepted;
    marker.rejected = residuals.rejected;
    marker.rms_px = residuals.inliers.rms_px();
    marker.verified = residuals.independent >= 2;
    marker.covariance = unknown_covariance();
    return marker;
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
