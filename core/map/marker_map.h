#pragma once

#include <Eigen/Core>
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

/// How many independent standard normals z, a map's modes, stand for what its markers share: the
/// errors of calibration and sizes that it was built with, and the drift that noise gives
/// neighbours alike.
inline constexpr int kMapModes = 16;

/// T: how a marker's pose moves with each mode, in the tangent of its covariances.
using ModeSensitivity = Eigen::Matrix<float, 6, kMapModes>;

/// One mapped marker.
struct MapMarker {
  MarkerId id;
  double stated_size_m = 0;  ///< from markers.toml
  double size_m = 0;         ///< effective: what the map was built with
  Rigid3 world_from_marker;
  /// Within the map (W): marginal 6×6 of `world_from_marker` in the tangent order of Rigid3 (m,
  /// rad; world axes), of what another round of the same rig would not repeat. Gauge: the mean
  /// motion of all marker positions removed; in the facility frame, the survey's.
  /// unknown_covariance() where it is not known.
  Matrix6d covariance = Matrix6d::Zero();
  /// Against the outside (C), what the calibration may be wrong by included; in the same gauge.
  /// unknown_covariance() where nothing is known beyond `covariance`, as in maps measured by hand.
  Matrix6d covariance_metric = unknown_covariance();
  ModeSensitivity modes = ModeSensitivity::Zero();  ///< T; T Tᵀ ≤ C
  std::uint32_t observations = 0;                   ///< accepted ones
  std::uint32_t rejected = 0;                       ///< rejected by the gate
  double rms_px = 0;                                ///< over the corners of accepted observations
  bool verified = false;                            ///< seen from at least two views that agree

  [[nodiscard]] bool covariance_known() const;
  /// Whether covariance_metric says more than `covariance`.
  [[nodiscard]] bool considered() const;
  /// C: covariance_metric, or `covariance` where that is all that is known.
  [[nodiscard]] const Matrix6d& metric() const;
  /// D = C − T Tᵀ: what no other marker shares; positive semidefinite. NaN where C is unknown.
  [[nodiscard]] Matrix6d own_covariance() const;
};

/// Gives a marker another world: pose, covariances and modes move.
void move_marker(const Rigid3& new_from_old, MapMarker& marker);

/// A number of the calibration or a stated size that a map considers: it may be wrong in the same
/// way in every image (core/estimate/consider_parameters.h).
struct MapParameter {
  std::string name;    ///< "cam1 position y": at most kMaxParameterText bytes
  std::string serial;  ///< of its camera, its first kMaxSerialText bytes; empty where not stated
  /// K: covariance of its error (true less used; m, rad, share, px, 1, s) with each mode.
  Eigen::Matrix<double, 1, kMapModes> cross = Eigen::Matrix<double, 1, kMapModes>::Zero();
};

inline constexpr std::size_t kMaxParameterText = 48;
inline constexpr std::size_t kMaxSerialText = 64;

/// Markers connected by observations, in one world frame.
struct SubMap {
  FrameKind frame = FrameKind::arbitrary;
  bool z_is_up = false;            ///< known: levelled, or the survey's frame
  std::vector<MapMarker> markers;  ///< by rising id
  std::uint32_t frame_sets = 0;    ///< localized while building
  double rms_px = 0;               ///< over the corners of accepted observations
  double rms_all_px = 0;  ///< over all observations of mapped markers in localized frame sets
  std::vector<MapParameter> parameters;  ///< that were considered; none in maps measured by hand
  Eigen::MatrixXd parameter_covariance;  ///< P, as the map leaves it
};

/// A marker map: what mapbuilder writes and locd trusts.
struct MarkerMap {
  std::string builder_version;
  std::string rig_fingerprint;                    ///< 16 hexadecimal digits
  std::vector<std::string> capture_fingerprints;  ///< sorted; independent of the captures' order
  std::vector<SubMap> submaps;                    ///< by falling marker count, then first id

  /// Whether anything is considered beyond the markers' own covariances.
  [[nodiscard]] bool considered() const;
  /// Whether ids must be written with their family.
  [[nodiscard]] bool several_families() const { return families().several(); }
  /// Those of its markers.
  [[nodiscard]] MeetingFamilies families() const;
};

}  // namespace waymark
