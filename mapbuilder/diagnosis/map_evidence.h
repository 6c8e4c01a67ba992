#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mapbuilder/build/map_builder.h"

namespace waymark {

/// A detection as the finished map can judge it: its camera's pose is known from other markers.
struct MarkerView {
  ObservationIndex index;
  FrameSetIndex frame_set;
  MarkerIndex marker;
  const MarkerObservation* observation = nullptr;  ///< as the evidence has it
  const RigCamera* camera = nullptr;
  Rigid3 world_from_cam;
  bool accepted = false;  ///< used, and by the gate
  int others = 0;         ///< accepted observations of other markers in the frame set
};

/// A place where a marker stands or stood, and how large it is.
struct SizedPlace {
  Rigid3 world_from_marker;
  double size_m = 0;
};

/// One component with the estimate that explains it best. World frame: the estimate's.
class MapEvidence {
 public:
  /// Observations as the estimate has them, with IPPE solutions. All must outlive the evidence.
  MapEvidence(const PreparedObservations& prepared, const Estimate& estimate,
              ComponentIndex component, const MapperOptions& options);

  [[nodiscard]] const Observations& observations() const { return prepared_.observations(); }
  /// Frame sets of the component, and all markers seen in them, in unused observations too; rising.
  [[nodiscard]] const std::vector<FrameSetIndex>& frame_sets() const {
    return component_.frame_sets;
  }
  [[nodiscard]] const std::vector<MarkerIndex>& markers() const { return markers_; }
  [[nodiscard]] const MapperOptions& options() const { return options_; }
  /// What an observation's squared residual (sigmas²) may be where it belongs.
  [[nodiscard]] double gate_sigmas2() const;

  [[nodiscard]] const Rig& rig_of(FrameSetIndex frame_set) const;
  /// By the user, whatever was corrected since.
  [[nodiscard]] double stated_size_m(MarkerIndex marker) const {
    return observations().stated_sizes_m[marker];
  }
  /// By the estimate.
  [[nodiscard]] double size_m(MarkerIndex marker) const {
    return estimate_.calibration.sizes_m[marker];
  }
  /// The estimated place of a marker.
  [[nodiscard]] const std::optional<SizedPlace>& place(MarkerIndex marker) const {
    return places_[marker];
  }
  /// World from rig of a localized, unambiguous frame set.
  [[nodiscard]] const std::optional<Rigid3>& world_from_rig(FrameSetIndex frame_set) const {
    return rigs_[frame_set];
  }
  /// Observations of a frame set, the unused included.
  [[nodiscard]] std::vector<const MarkerObservation*> seen_in(FrameSetIndex frame_set) const;

  /// Views of a marker, the unused included, by localized frame sets with at least `least_others`
  /// accepted observations of other markers; used ones first, each by rising index.
  [[nodiscard]] std::vector<MarkerView> views_of(MarkerIndex marker, int least_others) const;

  /// The same views, each camera's pose found again from the other markers alone: what a marker of
  /// wrong size did to the rig is undone. Views whose rig can't be found again are left out.
  [[nodiscard]] std::vector<MarkerView> independent_views_of(MarkerIndex marker,
                                                             int least_others) const;

  /// Everything seen in a frame set; where that has no pose, `world_from_cam` means nothing.
  [[nodiscard]] std::vector<MarkerView> views_in(FrameSetIndex frame_set) const;

  /// Accepted observations of a view's frame set of other markers, with their places.
  [[nodiscard]] std::vector<FixedMarkerObservation> others_of(const MarkerView& view) const;

  /// Algorithm 1 for one frame set, with the estimate's cameras.
  [[nodiscard]] RigPoseSolver solver_for(FrameSetIndex frame_set) const;

 private:
  [[nodiscard]] MarkerView view_of(ObservationIndex index) const;
  [[nodiscard]] std::vector<ObservationIndex> indices_in(FrameSetIndex frame_set) const;

  const PreparedObservations& prepared_;
  const Estimate& estimate_;
  const Component& component_;
  MapperOptions options_;
  std::vector<MarkerIndex> markers_;
  IndexedVector<MarkerIndex, std::optional<SizedPlace>> places_;
  IndexedVector<FrameSetIndex, std::optional<Rigid3>> rigs_;
  IndexedVector<MarkerIndex, std::vector<ObservationIndex>> unused_of_;
  IndexedVector<FrameSetIndex, std::vector<ObservationIndex>> unused_in_;
  IndexedVector<ObservationIndex, char> accepted_;  ///< and of a marker with a place
};

/// At most so many views, evenly spread.
[[nodiscard]] std::vector<MarkerView> thinned(std::vector<MarkerView> views, std::size_t most);

/// The view's observation as one of a marker of another size.
[[nodiscard]] MarkerObservation sized_as(const MarkerView& view, double size_m);

/// Root mean square distance (px) of a view's corners from where the place would show them;
/// infinite when it can't be projected or faces away.
[[nodiscard]] double distance_px(const MarkerView& view, const SizedPlace& place);

/// Σ of the squared whitened residuals of a view at a place, sigmas².
[[nodiscard]] double misfit_sigmas2(const MarkerView& view, const SizedPlace& place);

/// Side of the observed marker (px): the square root of its area.
[[nodiscard]] double side_px(const MarkerView& view);

}  // namespace waymark
