#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mapbuilder/build/map_builder.h"

namespace waymark {

/// A detection as the finished map can judge it: its camera's pose is known from other markers.
struct MarkerView {
  const TableObservation* observation = nullptr;
  const RigCamera* camera = nullptr;
  Rigid3 world_from_cam;
  std::size_t index =
      0;  ///< in the table's observations; from their count on: in its repeated ones
  bool accepted = false;  ///< by the gate
  int others = 0;         ///< accepted observations of other markers in the frame set
};

/// A place where a marker stands or stood, and how large it is.
struct SizedPlace {
  Rigid3 world_from_marker;
  double size_m = 0;
};

/// One component of the table with what explains it best. World frame: the fit's.
class MapEvidence {
 public:
  /// Overwrites the table's whitening by the fit's corner sigma, and the sizes of its repeated
  /// observations by those of their markers. `stated_sizes_m` (per marker) are the user's, whatever
  /// the table was corrected to. All must outlive the evidence.
  MapEvidence(ObservationTable& table, const ComponentFit& fit, const BuildOptions& options,
              const std::vector<double>& stated_sizes_m);

  [[nodiscard]] const ObservationTable& table() const { return table_; }
  /// Frame sets of the component, and all markers seen in them, the repeated included; rising.
  [[nodiscard]] const std::vector<int>& frame_sets() const { return fit_.component.frame_sets; }
  [[nodiscard]] const std::vector<int>& markers() const { return markers_; }
  [[nodiscard]] const BuildOptions& options() const { return options_; }
  /// What an observation's squared residual (sigmas²) may be where it belongs.
  [[nodiscard]] double gate_sigmas2() const;

  [[nodiscard]] const Rig& rig_of(int frame_set) const;
  [[nodiscard]] double stated_size_m(int marker) const {
    return stated_sizes_m_[static_cast<std::size_t>(marker)];
  }
  /// The fitted place of a marker (table index).
  [[nodiscard]] const std::optional<SizedPlace>& place(int marker) const {
    return places_[static_cast<std::size_t>(marker)];
  }
  /// World from rig of a localized, unambiguous frame set.
  [[nodiscard]] const std::optional<Rigid3>& world_from_rig(int frame_set) const {
    return rigs_[static_cast<std::size_t>(frame_set)];
  }
  /// Observations of a frame set, the repeated included.
  [[nodiscard]] std::vector<const TableObservation*> seen_in(int frame_set) const;

  /// Views of a marker, the repeated included, by localized frame sets with at least `least_others`
  /// accepted observations of other markers; by rising index.
  [[nodiscard]] std::vector<MarkerView> views_of(int marker, int least_others) const;

  /// The same views, each camera's pose found again from the other markers alone: what a marker of
  /// wrong size did to the rig is undone. Views whose rig can't be found again are left out.
  [[nodiscard]] std::vector<MarkerView> independent_views_of(int marker, int least_others) const;

  /// Everything seen in a frame set; where that has no pose, `world_from_cam` means nothing.
  [[nodiscard]] std::vector<MarkerView> views_in(int frame_set) const;

  /// Accepted observations of a view's frame set of other markers, with their places.
  [[nodiscard]] std::vector<FixedMarkerObservation> others_of(const MarkerView& view) const;

  /// Algorithm 1 for one frame set, with the fit's cameras.
  [[nodiscard]] RigPoseSolver solver_for(int frame_set) const;

 private:
  [[nodiscard]] MarkerView view_of(const TableObservation& o, std::size_t index) const;
  [[nodiscard]] const TableObservation& observation(std::size_t index) const;
  [[nodiscard]] std::vector<std::size_t> indices_in(int frame_set) const;
  [[nodiscard]] bool is_accepted(std::size_t index) const;

  const ObservationTable& table_;
  const ComponentFit& fit_;
  BuildOptions options_;
  const std::vector<double>& stated_sizes_m_;
  std::vector<int> markers_;
  std::vector<std::optional<SizedPlace>> places_;
  std::vector<std::optional<Rigid3>> rigs_;
  std::vector<std::vector<std::size_t>> repeated_of_;  ///< per marker, indices as in MarkerView
  std::vector<std::vector<std::size_t>> repeated_in_;  ///< per frame set, likewise
  std::vector<char> accepted_;
};

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
