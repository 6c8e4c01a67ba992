#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/mapping/map_builder.h"
#include "mapbuilder/mapping/map_state.h"

namespace waymark {

/// A detection as the finished map can judge it: its camera's pose is known from other markers.
struct MarkerView {
  const TableObservation* observation = nullptr;
  const RigCamera* camera = nullptr;
  Rigid3 world_from_cam;
  std::size_t index = 0;  ///< in the table's observations
  bool accepted = false;  ///< by the gate
  int others = 0;         ///< accepted observations of other markers in the frame set
};

/// A place where a marker stands or stood, and how large it is.
struct SizedPlace {
  Rigid3 world_from_marker;
  double size_m = 0;
};

/// A sub-map with all that the table knows of it. World frame: the sub-map's.
class MapEvidence {
 public:
  /// Overwrites the table's whitening by the sub-map's corner sigma. Table and sub-map must outlive
  /// the evidence.
  MapEvidence(ObservationTable& table, const BuiltSubMap& submap, const BuildOptions& options);

  [[nodiscard]] const ObservationTable& table() const { return table_; }
  [[nodiscard]] const BuiltSubMap& submap() const { return submap_; }
  [[nodiscard]] const BuildOptions& options() const { return options_; }

  /// The mapped place of a marker (table index).
  [[nodiscard]] const std::optional<SizedPlace>& place(int marker) const {
    return places_[static_cast<std::size_t>(marker)];
  }
  /// World from rig of a localized, unambiguous frame set.
  [[nodiscard]] const std::optional<Rigid3>& world_from_rig(int frame_set) const {
    return rigs_[static_cast<std::size_t>(frame_set)];
  }
  /// Accepted observations of a frame set.
  [[nodiscard]] int accepted_in(int frame_set) const {
    return accepted_in_set_[static_cast<std::size_t>(frame_set)];
  }

  /// Views of a marker by localized frame sets with at least `least_others` accepted observations
  /// of other markers; by rising index.
  [[nodiscard]] std::vector<MarkerView> views_of(int marker, int least_others) const;

  /// The same views, each camera's pose found again from the other markers alone: what a marker of
  /// wrong size did to the rig is undone. Views whose rig can't be found again are left out.
  [[nodiscard]] std::vector<MarkerView> independent_views_of(int marker, int least_others) const;

 private:
  [[nodiscard]] MarkerView view_of(const TableObservation& o, std::size_t index) const;

  const ObservationTable& table_;
  const BuiltSubMap& submap_;
  BuildOptions options_;
  std::vector<std::optional<SizedPlace>> places_;
  std::vector<std::optional<Rigid3>> rigs_;
  std::vector<int> accepted_in_set_;
  std::vector<char> accepted_;
};

/// Root mean square distance (px) of a view's corners from where the place would show them;
/// infinite when it can't be projected or faces away.
[[nodiscard]] double distance_px(const MarkerView& view, const SizedPlace& place);

/// Σ of the squared whitened residuals of a view at a place, sigmas².
[[nodiscard]] double misfit_sigmas2(const MarkerView& view, const SizedPlace& place);

/// Side of the observed marker (px): the square root of its area.
[[nodiscard]] double side_px(const MarkerView& view);

}  // namespace waymark
