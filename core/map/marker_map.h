#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/marker/marker_id.h"

namespace waymark {

/// What a sub-map's world frame and scale rest on. Values are stored in map files: only append.
enum class FrameKind : std::uint8_t {
  arbitrary = 0,  ///< origin and axes by the mapper's choice, scale by the stated marker sizes
  scaled = 1,     ///< the same, scale fitted to measured distances
  facility = 2,   ///< origin, axes and scale of the survey
};

/// An unknown covariance: NaN throughout, so that no computation takes it for a known one.
[[nodiscard]] Matrix6d unknown_covariance();

/// One mapped marker.
struct MapMarker {
  MarkerId id;
  double stated_size_m = 0;  ///< from markers.toml
  double size_m = 0;         ///< effective: what the map was built with
  Rigid3 world_from_marker;
  /// Marginal 6×6 of `world_from_marker` in the tangent order of Rigid3 (m, rad; world axes).
  /// Gauge: the mean motion of all marker positions removed; in the facility frame, the survey's.
  /// unknown_covariance() where it is not known.
  Matrix6d covariance = Matrix6d::Zero();
  std::uint32_t observations = 0;  ///< accepted ones
  std::uint32_t rejected = 0;      ///< rejected by the gate
  double rms_px = 0;               ///< over the corners of accepted observations
  bool verified = false;           ///< seen from at least two views that agree

  [[nodiscard]] bool covariance_known() const;
};

/// Markers connected by observations, in one world frame.
struct SubMap {
  FrameKind frame = FrameKind::arbitrary;
  bool z_is_up = false;            ///< known: levelled, or the survey's frame
  std::vector<MapMarker> markers;  ///< by rising id
  std::uint32_t frame_sets = 0;    ///< localized while building
  double rms_px = 0;               ///< over the corners of accepted observations
  double rms_all_px = 0;  ///< over all observations of mapped markers in localized frame sets
};

/// A marker map: what mapbuilder writes and locd trusts.
struct MarkerMap {
  std::string builder_version;
  std::string rig_fingerprint;                    ///< 16 hexadecimal digits
  std::vector<std::string> capture_fingerprints;  ///< sorted; independent of the captures' order
  std::vector<SubMap> submaps;                    ///< by falling marker count, then first id

  /// Whether ids must be written with their family.
  [[nodiscard]] bool several_families() const { return families().several(); }
  /// Those of its markers.
  [[nodiscard]] MeetingFamilies families() const;
};

}  // namespace waymark
