#include "mapbuilder/growth/relocalization.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "mapbuilder/growth/frame_set_localization.h"

namespace waymark {
namespace {

/// Sums of squared corner residuals.
struct CornerSum {
  double squared_px2 = 0;
  std::size_t corners = 0;

  void add(const std::array<Eigen::Vector2d, 4>& residuals) {
    double sum = 0;
    for (const Eigen::Vector2d& r : residuals) sum += r.squaredNorm();
    squared_px2 += sum;
    corners += 4;
  }
  [[nodiscard]] double rms_px() const {
    return corners == 0 ? 0.0 : std::sqrt(squared_px2 / static_cast<double>(corners));
  }
};

/// The frame sets of one capture against one sub-map.
class SubMapLocalizer {
 public:
  SubMapLocalizer(const Selection& selection, const SubMap& submap, const MapperOptions& options)
      : selection_(selection),
        options_(options),
        noise_(options.noise),
        estimate_(with_markers_of(submap, Estimate(selection, options.noise))) {
    for (const ObservationIndex index : selection.used()) {
      if (!estimate_.world_from_marker[selection[index].marker]) continue;
      observations_.push_back(index);
      ++seen_[selection[index].frame_set];
    }
    for (const auto& [frame_set, count] : seen_) frame_sets_.push_back(frame_set);
  }

  [[nodiscard]] RelocalizedSubMap run() {
    PreparedObservations prepared(selection_, estimate_, options_.threads);
    // The first round finds the poses; the second repeats it in sigmas that the residuals gave.
    for (int round = 0; round < 2; ++round) {
      estimate_ = localize(prepared, frame_sets_, options_, std::move(estimate_));
      const std::vector<ObservationIndex> posed = posed_observations();
      fit_noise(prepared, posed);
      estimate_ = gate_outliers(prepared, posed, options_.gate, std::move(estimate_)).estimate;
      for (ComponentEstimate& component : estimate_.components) component.noise = noise_;
      prepared.update(estimate_);
    }
    estimate_ = localize(prepared, frame_sets_, options_, std::move(estimate_));
    drop_poses_of_rejected_observations();
    RelocalizedSubMap result;
    result.model_sigma_px = noise_.model_sigma_px;
    add_residuals(prepared, result);
    add_poses(result);
    return result;
  }

 private:
  [[nodiscard]] Estimate with_markers_of(const SubMap& submap, Estimate estimate) const {
    std::map<MarkerId, const MapMarker*> mapped;
    for (const MapMarker& marker : submap.markers) mapped.emplace(marker.id, &marker);
    for (const MarkerIndex m : estimate.world_from_marker.indices()) {
      const auto known = mapped.find(selection_.observations().markers[m]);
      if (known == mapped.end()) continue;
      estimate.world_from_marker[m] = known->second->world_from_marker;
      estimate.calibration.sizes_m[m] = known->second->size_m;
    }
    return estimate;
  }

  [[nodiscard]] std::vector<ObservationIndex> posed_observations() const {
    std::vector<ObservationIndex> posed;
    for (const ObservationIndex index : observations_) {
      if (estimate_.posed(selection_[index])) posed.push_back(index);
    }
    return posed;
  }

  void fit_noise(const PreparedObservations& prepared, std::span<const ObservationIndex> posed) {
    const double share = 6.0 * static_cast<double>(seen_.size()) /
                         (8.0 * static_cast<double>(std::max<std::size_t>(1, posed.size())));
    noise_.model_sigma_px =
        estimate_model_sigma_px(prepared, estimate_, posed, noise_, std::min(share, 0.8));
  }

  /// A pose that only rejected observations speak for is none.
  void drop_poses_of_rejected_observations() {
    std::map<FrameSetIndex, int> accepted_in;
    for (const ObservationIndex index : observations_) {
      accepted_in[selection_[index].frame_set] += estimate_.accepted[index];
    }
    for (const auto& [frame_set, accepted] : accepted_in) {
      if (accepted == 0) estimate_.world_from_rig[frame_set].reset();
    }
  }

  void add_residuals(const PreparedObservations& prepared, RelocalizedSubMap& result) const {
    const Observations& all = selection_.observations();
    CornerSum inliers;
    CornerSum every;
    for (const ObservationIndex index : observations_) {
      const Observation& o = all[index];
      if (!estimate_.posed(o)) continue;
      const auto residuals =
          corner_residuals(prepared[index], estimate_.calibration.camera(all, o).model,
                           cam_from_marker(all, estimate_, o));
      ++result.observations;
      if (!estimate_.accepts(index) || !residuals) ++result.rejected;
      if (!residuals) continue;
      every.add(*residuals);
      if (estimate_.accepts(index)) inliers.add(*residuals);
    }
    result.rms_all_px = every.rms_px();
    result.rms_px = inliers.rms_px();
  }

  void add_poses(RelocalizedSubMap& result) const {
    for (const auto& [frame_set, count] : seen_) {
      result.candidates += count >= 2 ? 1 : 0;
      const auto& rig = estimate_.world_from_rig[frame_set];
      if (!rig) continue;
      if (rig->ambiguous) {
        result.ambiguous.push_back(frame_set);
      } else {
        result.localized += count >= 2 ? 1 : 0;
        result.trajectory.push_back({frame_set, rig->best.pose});
      }
    }
  }

  const Selection& selection_;
  const MapperOptions& options_;
  NoiseModel noise_;
  Estimate estimate_;
  std::vector<ObservationIndex> observations_;  ///< of the sub-map's markers
  std::map<FrameSetIndex, int> seen_;           ///< how many of them a frame set holds
  std::vector<FrameSetIndex> frame_sets_;
};

}  // namespace

std::vector<RelocalizedSubMap> relocalize(const Observations& observations, const MarkerMap& map,
                                          const MapperOptions& options, Progress& progress) {
  const Selection selection(observations);
  const MapperOptions counted = effective(options);
  std::vector<RelocalizedSubMap> results;
  progress.begin("localizing", map.submaps.size());
  for (const SubMap& submap : map.submaps) {
    results.push_back(SubMapLocalizer(selection, submap, counted).run());
    progress.update(results.size());
  }
  progress.end();
  return results;
}

}  // namespace waymark
