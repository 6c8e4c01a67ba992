#include "mapbuilder/mapping/map_builder.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "mapbuilder/mapping/marker_covariances.h"

namespace waymark {
namespace {

/// Sums of squared corner residuals over observations.
struct ResidualSum {
  double squared_px2 = 0;
  std::size_t corners = 0;
  void add(const std::array<Eigen::Vector2d, 4>& residuals) {
    for (const Eigen::Vector2d& r : residuals) squared_px2 += r.squaredNorm();
    corners += 4;
  }
  [[nodiscard]] double rms_px() const {
    return corners == 0 ? 0.0 : std::sqrt(squared_px2 / static_cast<double>(corners));
  }
};

/// Everything one component's build works on.
class ComponentBuilder {
 public:
  ComponentBuilder(ObservationTable& table, const Component& component, const BuildOptions& options,
                   Progress& progress)
      : table_(table),
        component_(component),
        options_(options),
        progress_(progress),
        noise_(options.noise),
        state_(table) {
    options_.growth.rig_pose.loss = options.loss;
    options_.growth.placement.loss = options.loss;
    options_.growth.threads = options.threads;
    for (const int frame_set : component.frame_sets) {
      const TableFrameSet& set = table.frame_sets[static_cast<std::size_t>(frame_set)];
      for (std::size_t i = 0; i < set.observation_count; ++i) {
        observations_.push_back(set.first_observation + i);
      }
    }
    anchor_ = choose_seed(table, component);
    held_.frame_set = anchor_;
  }

  /// Captures, detections, graph → poses of markers and rigs.
  void build() {
    set_whitening(table_, noise_);
    Growth growth(table_, component_, options_.growth);
    progress_.begin("growing the map", component_.markers.size());
    growth.grow(
        anchor_, state_,
        [&](const std::vector<int>& markers, MapState& state) { adjust_fresh(markers, state); },
        [&](MapState& state) {
          // Sigmas as large as what growth has piled up: then the loss bends for outliers alone,
          // and a few steps lead to the optimum.
          adapt_noise();
          adjust(growth, {options_.loss, 10, 1e-3, 1e-6, threads_, {}});
          adapt_noise();
          if (growth.reconsider(state) > 0)
            adjust(growth, {options_.loss, 10, 1e-3, 1e-6, threads_, {}});
        },
        [&](std::size_t placed, std::size_t localized) {
          progress_.update(placed, fmt::format("{} of {} frame sets localized", localized,
                                               component_.frame_sets.size()));
        });
    progress_.end();
    settle(growth);
    calibrate(growth);
  }

  [[nodiscard]] const MapState& state() const { return state_; }
  [[nodiscard]] const std::vector<std::size_t>& observations() const { return observations_; }
  [[nodiscard]] double model_sigma_px() const { return noise_.model_sigma_px; }
  [[nodiscard]] bool settled() const { return settled_; }
  [[nodiscard]] const AdjustmentScope& scope() const { return scope_; }
  [[nodiscard]] const HeldPoses& held() const { return held_; }
  [[nodiscard]] const std::optional<CalibrationResult>& calibration() const { return calibration_; }

 private:
  /// Adjusts jointly; frame sets with one accepted marker take no part and follow.
  AdjustmentSummary adjust(const Growth& growth, const AdjustmentOptions& options) {
    AdjustmentOptions scoped = options;
    scoped.scope = scope_;
    const AdjustmentSummary summary = adjust_jointly(table_, observations_, held_, scoped, state_);
    if (summary.uncertainty) uncertainty_ = *summary.uncertainty;
    growth.localize_unadjusted(state_);
    return summary;
  }

  /// Adjusts markers that were just placed, with the frame sets that see them, against the rest:
  /// what is placed next rests on them.
  void adjust_fresh(const std::vector<int>& markers, MapState& state) const {
    HeldPoses held{anchor_, std::vector<char>(table_.markers.size(), 1)};
    std::set<int> sets;
    for (const int marker : markers) {
      held.markers[static_cast<std::size_t>(marker)] = 0;
      for (const std::size_t index :
           table_.observations_of_marker[static_cast<std::size_t>(marker)]) {
        sets.insert(table_.observations[index].frame_set);
      }
    }
    std::vector<std::size_t> observations;
    for (const int frame_set : sets) {
      const TableFrameSet& set = table_.frame_sets[static_cast<std::size_t>(frame_set)];
      for (std::size_t i = 0; i < set.observation_count; ++i) {
        observations.push_back(set.first_observation + i);
      }
    }
    adjust_jointly(table_, observations, held, {options_.loss, 6, 1e-2, 1e-6, threads_, {}}, state);
  }

  /// Re-estimates the model's sigma and the whitening that follows from it; returns its relative
  /// change.
  double adapt_noise() {
    std::vector<std::size_t> posed;
    std::set<int> sets;
    std::set<int> markers;
    for (const std::size_t index : observations_) {
      const TableObservation& o = table_.observations[index];
      if (!state_.posed(o)) continue;
      posed.push_back(index);
      sets.insert(o.frame_set);
      markers.insert(o.marker);
    }
    // Fewer residuals than that say nothing about their own size.
    constexpr double kMostParametersPerResidual = 0.8;
    const double share = 6.0 * static_cast<double>(sets.size() + markers.size()) /
                         (8.0 * static_cast<double>(std::max<std::size_t>(1, posed.size())));
    if (share > kMostParametersPerResidual) return 0.0;
    const double before = noise_.model_sigma_px;
    noise_.model_sigma_px = estimate_model_sigma_px(table_, state_, posed, noise_, share);
    set_whitening(table_, noise_);
    return std::abs(noise_.model_sigma_px / before - 1.0);
  }

  /// Takes survey and refinement into the adjustment, from the map that stands without them; puts
  /// everything back when the data can't support what was asked for.
  void calibrate(const Growth& growth) {
    const SurveyReach reach = reach_of(options_.survey, table_, state_);
    FreeCalibration free = options_.refine;
    // What the survey measures against the stated sizes is the printer's and the camera's doing.
    free.sizes = free.sizes || reach.scale;
    free.edge_bias = reach.scale;
    if (!free.any() && !reach.scale) {
      try_calibration();
      return;
    }
    const ObservationTable table_before = table_;
    const MapState state_before = state_;
    const bool settled_before = settled_;
    calibration_.emplace();
    calibration_->rigs_before = table_.rigs;

    if (reach.frame) move_world(*facility_from_world(options_.survey, table_, state_));
    scope_.free = free;
    scope_.survey = reach.scale ? &options_.survey : nullptr;
    scope_.world_is_facility = reach.frame;
    for (const Rig& rig : table_.rigs) {
      scope_.stated_cameras.insert(scope_.stated_cameras.end(), rig.cameras.begin(),
                                   rig.cameras.end());
    }
    held_.frame_set = reach.frame ? -1 : anchor_;
    const NoiseModel noise_before = noise_;
    adjust(growth, {options_.loss, 50, 1e-7, 1e-6, threads_, {}});
    // Judged once settled: a misfit rig passes for noise until it is refined.
    settle(growth);
    if (hold_what_is_unsure()) settle(growth);
    calibration_->uncertainty = uncertainty_;
    calibration_->refused = unsupported(uncertainty_);
    if (calibration_->refused.empty()) {
      calibration_->applied = true;
      calibration_->rigs_fitted = table_.rigs;
      return;
    }
    table_ = table_before;
    state_ = state_before;
    noise_ = noise_before;
    scope_ = {};
    held_.frame_set = anchor_;
    settled_ = settled_before;
  }

  /// Whether the rig file fits the images: a few steps with all of it free, on copies. What they
  /// find is evidence, the map stays as it is.
  void try_calibration() {
    ObservationTable table = table_;
    MapState state = state_;
    AdjustmentOptions options{options_.loss, 4, 1e-2, 1e-6, threads_, {}};
    calibration_.emplace();
    calibration_->rigs_before = table_.rigs;
    const auto free_and_adjust = [&] {
      const AdjustmentSummary summary = adjust_jointly(table, observations_, held_, options, state);
      if (summary.uncertainty) calibration_->uncertainty = *summary.uncertainty;
      return summary.initial_cost > 0 ? summary.final_cost / summary.initial_cost : 1.0;
    };
    const bool several_cameras = std::any_of(table_.rigs.begin(), table_.rigs.end(),
                                             [](const Rig& rig) { return rig.cameras.size() > 1; });
    if (several_cameras) {
      options.scope.free.extrinsics = true;
      calibration_->extrinsics_cost_ratio = free_and_adjust();
    }
    // Extrinsics first: what they explain is not the lens's fault.
    const ObservationTable with_extrinsics = table;
    const CalibrationUncertainty of_extrinsics = calibration_->uncertainty;
    options.scope.free.intrinsics = true;
    calibration_->intrinsics_cost_ratio = free_and_adjust();
    calibration_->rigs_fitted = table.rigs;
    if (calibration_->intrinsics_cost_ratio > kExplainsTooLittle && several_cameras) {
      calibration_->rigs_fitted = with_extrinsics.rigs;
      calibration_->uncertainty = of_extrinsics;
    }
  }

  void move_world(const Rigid3& new_from_old) {
    for (const int marker : component_.markers) {
      auto& pose = state_.world_from_marker[static_cast<std::size_t>(marker)];
      if (pose) pose = new_from_old * *pose;
    }
    for (const int frame_set : component_.frame_sets) {
      auto& rig = state_.rigs[static_cast<std::size_t>(frame_set)];
      if (!rig) continue;
      rig->best.pose = new_from_old * rig->best.pose;
      if (rig->runner_up) rig->runner_up->pose = new_from_old * rig->runner_up->pose;
    }
  }

  /// Finds the directions of extrinsics and focal lengths that are less sure than the limits and
  /// holds them from now on. False when there are none.
  bool hold_what_is_unsure() {
    const Eigen::MatrixXd& joint = uncertainty_.joint;
    const std::size_t cameras = scope_.stated_cameras.size();
    if (joint.size() == 0) return false;
    // In units of the limits: an eigenvalue above 1 is a direction that can't be supported.
    const RefinementLimits& limits = options_.refinement_limits;
    Eigen::VectorXd per_limit(joint.rows());
    for (std::size_t c = 0; c < cameras; ++c) {
      const auto row = static_cast<Eigen::Index>(6 * c);
      per_limit.segment<3>(row).setConstant(1.0 / limits.position_m);
      per_limit.segment<3>(row + 3).setConstant(1.0 / limits.rotation_rad);
      per_limit.segment<2>(static_cast<Eigen::Index>(6 * cameras + 2 * c))
          .setConstant(1.0 / (limits.focal * scope_.stated_cameras[c].model.parameters().fu_px));
    }
    const Eigen::MatrixXd scaled = per_limit.asDiagonal() * joint * per_limit.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
    for (Eigen::Index i = 0; i < scaled.rows(); ++i) {
      if (eigen.eigenvalues()[i] <= 1.0) continue;
      const Eigen::VectorXd weights = per_limit.cwiseProduct(eigen.eigenvectors().col(i));
      HeldDirection direction;
      Eigen::Index most = 0;
      for (std::size_t c = 0; c < cameras; ++c) {
        direction.extrinsics.emplace_back(weights.segment<6>(static_cast<Eigen::Index>(6 * c)));
        direction.focal.emplace_back(
            weights.segment<2>(static_cast<Eigen::Index>(6 * cameras + 2 * c)));
      }
      eigen.eigenvectors().col(i).cwiseAbs().maxCoeff(&most);
      scope_.held_directions.push_back(direction);
      calibration_->held.push_back(held_direction_text(most, std::sqrt(eigen.eigenvalues()[i])));
    }
    return !scope_.held_directions.empty();
  }

  /// "cam2's position: known to ± 4.2 mm only, 2 mm is asked for", of the direction's largest part.
  [[nodiscard]] std::string held_direction_text(Eigen::Index row, double limits) const {
    const RefinementLimits& limit = options_.refinement_limits;
    const auto cameras = static_cast<Eigen::Index>(scope_.stated_cameras.size());
    const bool focal = row >= 6 * cameras;
    const Eigen::Index camera = focal ? (row - 6 * cameras) / 2 : row / 6;
    const auto text = [&](const char* what, double allowed, const char* unit) {
      return fmt::format(
          "{}'s {} with what moves along: known to ± {:.2g} {} only, {:.2g} is asked for",
          scope_.stated_cameras[static_cast<std::size_t>(camera)].name, what, limits * allowed,
          unit, allowed);
    };
    if (focal) return text("focal length", 100 * limit.focal, "%");
    if (row % 6 < 3) return text("position", 1e3 * limit.position_m, "mm");
    return text("orientation", 57.29578 * limit.rotation_rad, "°");
  }

  /// Why a calibration can't be trusted, a line each.
  [[nodiscard]] std::vector<std::string> unsupported(const CalibrationUncertainty& sure) const {
    const RefinementLimits& limits = options_.refinement_limits;
    std::vector<std::string> reasons;
    std::size_t index = 0;
    for (const Rig& rig : table_.rigs) {
      if (options_.refine.extrinsics && rig.cameras.size() < 2) {
        reasons.push_back("extrinsics: a rig of one camera has none");
      }
      for (const RigCamera& camera : rig.cameras) {
        const CameraUncertainty& own = sure.cameras[index++];
        const auto judge = [&](const char* what, double sigma, double limit, double scale,
                               const char* unit) {
          if (!(sigma > limit)) return;
          reasons.push_back(fmt::format("{}: {} known to ± {:.3g} {} only, {:.3g} {} is asked for",
                                        camera.name, what, sigma * scale, unit, limit * scale,
                                        unit));
        };
        judge("position", own.position_m, limits.position_m, 1e3, "mm");
        judge("orientation", own.rotation_rad, limits.rotation_rad, 57.29578, "°");
        judge("focal length", own.focal, limits.focal, 100, "%");
      }
    }
    if (options_.refine.sizes) {
      for (const double sigma : sure.size_factor) {
        if (sigma > limits.size) {
          reasons.push_back(
              fmt::format("sizes: known to ± {:.2g} % only, {:.2g} % is asked for: nothing but the "
                          "stated sizes tells the scale; measure a distance (survey.toml)",
                          100 * sigma, 100 * limits.size));
          break;
        }
      }
    }
    return reasons;
  }

  /// Adjusts, reconsiders flips and gates until nothing changes any more.
  void settle(const Growth& growth) {
    constexpr double kNoiseSettled = 0.02;
    settled_ = false;
    progress_.begin("adjusting jointly", static_cast<std::size_t>(options_.max_passes));
    adapt_noise();
    for (int pass = 0; pass < options_.max_passes; ++pass) {
      adjust(growth, {options_.loss, 30, 1e-4, 1e-8, threads_, {}});
      const double noise_change = adapt_noise();
      const std::size_t reconsidered = growth.reconsider(state_);
      const std::size_t gated = update_gate(table_, observations_, options_.gate, state_);
      progress_.update(static_cast<std::size_t>(pass) + 1,
                       fmt::format("model sigma {:.3f} px", noise_.model_sigma_px));
      if (reconsidered + gated == 0 && noise_change < kNoiseSettled) break;
    }
    // The last adjustment is one of exactly the observations that the last gate accepts.
    constexpr int kMostPolishes = 5;
    for (int polish = 0; polish < kMostPolishes && !settled_; ++polish) {
      const AdjustmentSummary summary =
          adjust(growth, {options_.loss, 50, 1e-9, 1e-14, threads_, {}});
      const bool converged = summary.converged || summary.observations == 0;
      settled_ = converged && update_gate(table_, observations_, options_.gate, state_) == 0;
    }
    progress_.end();
  }

  ObservationTable& table_;
  const Component& component_;
  BuildOptions options_;
  int threads_ = effective_threads(options_.threads);
  Progress& progress_;
  NoiseModel noise_;
  MapState state_;
  std::vector<std::size_t> observations_;
  int anchor_ = -1;
  HeldPoses held_;
  AdjustmentScope scope_;
  CalibrationUncertainty uncertainty_;  ///< of the last adjustment that freed a calibration
  std::optional<CalibrationResult> calibration_;
  bool settled_ = false;
};

/// Marks each observation that the finished map rests on.
std::vector<char> accepted_and_posed(const ObservationTable& table, const ComponentBuilder& built) {
  std::vector<char> used(table.observations.size(), 0);
  for (const std::size_t index : built.observations()) {
    if (built.state().accepted[index] != 0 && built.state().posed(table.observations[index])) {
      used[index] = 1;
    }
  }
  return used;
}

/// Statistics, covariances and trajectory of one rigid part of a finished component.
BuiltSubMap describe(const ObservationTable& table, const ComponentBuilder& built,
                     const Component& part, const BuildOptions& options) {
  const MapState& state = built.state();
  BuiltSubMap result;
  result.model_sigma_px = built.model_sigma_px();
  result.settled = built.settled();
  result.calibration = built.calibration();

  const std::set<int> part_sets(part.frame_sets.begin(), part.frame_sets.end());
  std::vector<std::size_t> observations;
  for (const std::size_t index : built.observations()) {
    const TableObservation& o = table.observations[index];
    if (part_sets.contains(o.frame_set) && state.posed(o)) observations.push_back(index);
  }
  result.observations = observations.size();

  std::map<int, int> accepted_in_set;
  for (const std::size_t index : observations) {
    accepted_in_set[table.observations[index].frame_set] += state.accepted[index];
  }

  ResidualSum inliers;
  ResidualSum all;
  std::vector<ResidualSum> per_marker(table.markers.size());
  std::vector<std::uint32_t> rejected(table.markers.size(), 0);
  std::vector<std::uint32_t> accepted(table.markers.size(), 0);
  // Views by rigs that other markers place as well: only these can contradict a marker's place.
  std::vector<std::uint32_t> independent(table.markers.size(), 0);
  for (const std::size_t index : observations) {
    const TableObservation& o = table.observations[index];
    const auto marker = static_cast<std::size_t>(o.marker);
    const auto residuals =
        corner_residuals(o, camera_of(table, o).model, cam_from_marker(table, state, o));
    if (residuals) {
      all.add(*residuals);
      result.residuals.push_back({index, state.accepted[index] != 0, *residuals});
    }
    if (state.accepted[index] == 0 || !residuals) {
      ++rejected[marker];
      ++result.rejected;
      continue;
    }
    ++accepted[marker];
    independent[marker] += accepted_in_set[o.frame_set] >= 2 ? 1 : 0;
    inliers.add(*residuals);
    per_marker[marker].add(*residuals);
  }
  result.map.rms_px = inliers.rms_px();
  result.map.rms_all_px = all.rms_px();

  // The seed's rig frame is the world (paper §III-F.1), of each rigid part its own.
  const auto seed = static_cast<std::size_t>(choose_seed(table, part));
  const AdjustmentScope& scope = built.scope();
  const Rigid3 world_from_built =
      scope.world_is_facility ? Rigid3{} : state.rigs[seed]->best.pose.inverse();
  if (scope.survey != nullptr) {
    result.map.frame = scope.world_is_facility ? FrameKind::facility : FrameKind::scaled;
  }
  result.survey = survey_residuals(options.survey, table, state, scope.world_is_facility);
  for (const int frame_set : part.frame_sets) {
    const RigPoseEstimate& rig = *state.rigs[static_cast<std::size_t>(frame_set)];
    if (rig.ambiguous) {
      result.ambiguous.push_back(frame_set);
    } else {
      result.trajectory.push_back({frame_set, world_from_built * rig.best.pose});
    }
  }
  result.map.frame_sets = static_cast<std::uint32_t>(result.trajectory.size());

  const MarkerInformation information = marker_information(
      table, observations, options.loss, scope, effective_threads(options.threads), state);
  const std::vector<Matrix6d> covariances = marker_covariances(information);
  result.covariances_known = !covariances.empty() || part.markers.size() < 2;
  const Matrix6d turn = left_motion_jacobian(world_from_built);
  for (const int index : part.markers) {
    const auto m = static_cast<std::size_t>(index);
    MapMarker marker;
    marker.id = table.markers[m];
    marker.stated_size_m = table.stated_sizes_m[m];
    marker.size_m = table.sizes_m[m];
    marker.world_from_marker = world_from_built * *state.world_from_marker[m];
    marker.observations = accepted[m];
    marker.rejected = rejected[m];
    marker.rms_px = per_marker[m].rms_px();
    marker.verified = independent[m] >= 2;
    const auto slot =
        std::lower_bound(information.markers.begin(), information.markers.end(), index);
    if (!covariances.empty() && slot != information.markers.end() && *slot == index) {
      const Matrix6d& covariance =
          covariances[static_cast<std::size_t>(slot - information.markers.begin())];
      const Matrix6d turned = turn * covariance * turn.transpose();
      marker.covariance = 0.5 * (turned + turned.transpose());
    }
    result.map.markers.push_back(marker);
  }
  return result;
}

}  // namespace

BuildResult build_map(ObservationTable& table, const BuildOptions& options, Progress& progress) {
  BuildResult result;
  result.map.builder_version = WAYMARK_VERSION;
  result.map.capture_fingerprints = table.capture_fingerprints;
  std::sort(result.map.capture_fingerprints.begin(), result.map.capture_fingerprints.end());
  result.map.rig_fingerprint = table.rig_fingerprint;

  std::set<int> mapped;
  std::set<int> localized;
  const std::vector<char> everything(table.observations.size(), 1);
  for (const Component& component : connected_components(table, everything)) {
    ComponentBuilder builder(table, component, options, progress);
    builder.build();
    // What the gate rejected may have held the component together: each rigid part is a sub-map of
    // its own.
    for (const Component& part : connected_components(table, accepted_and_posed(table, builder))) {
      result.submaps.push_back(describe(table, builder, part, options));
      mapped.insert(part.markers.begin(), part.markers.end());
      localized.insert(part.frame_sets.begin(), part.frame_sets.end());
    }
  }
  std::stable_sort(result.submaps.begin(), result.submaps.end(),
                   [](const BuiltSubMap& a, const BuiltSubMap& b) {
                     if (a.map.markers.size() != b.map.markers.size()) {
                       return a.map.markers.size() > b.map.markers.size();
                     }
                     return a.map.markers.front().id < b.map.markers.front().id;
                   });
  for (const BuiltSubMap& submap : result.submaps) result.map.submaps.push_back(submap.map);

  for (std::size_t m = 0; m < table.markers.size(); ++m) {
    if (!mapped.contains(static_cast<int>(m))) result.unmapped.push_back(table.markers[m]);
  }
  for (std::size_t f = 0; f < table.frame_sets.size(); ++f) {
    if (table.frame_sets[f].observation_count == 0) {
      result.without_markers.push_back(static_cast<int>(f));
    } else if (!localized.contains(static_cast<int>(f))) {
      result.unlocalized.push_back(static_cast<int>(f));
    }
  }
  return result;
}

}  // namespace waymark
