#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/camera/rig.h"
#include "core/capture/detection.h"
#include "core/capture/frame_set.h"
#include "core/estimate/marker_observation.h"
#include "core/marker/marker_catalog.h"

namespace waymark {

/// A capture with its detections made or read: what mapping starts from.
struct DetectedCapture {
  std::string name;  ///< for messages
  Rig rig;
  MarkerCatalog catalog;
  std::vector<ImageDetections> images;  ///< by rising (stamp, camera)
  Stamp sync_tolerance = kDefaultSyncTolerance;
  bool monotonic = false;  ///< its stamps can't be compared with another capture's
  /// Rows of its detections.csv of a stated family that markers.toml neither sizes nor ignores.
  std::map<MarkerId, int> unlisted{};
};

/// 16 hexadecimal digits that depend on a rig's numbers, or on a capture's detections, and nothing
/// else.
[[nodiscard]] std::string fingerprint(const Rig& rig);
[[nodiscard]] std::string fingerprint(const DetectedCapture& capture);

/// Whether two rigs are one: the same names and numbers, and no serial that says otherwise.
[[nodiscard]] bool are_same(const Rig& a, const Rig& b);

/// One observation as mapping sees it.
struct TableObservation : MarkerObservation {
  int frame_set = 0;              ///< index
  int marker = 0;                 ///< index
  CornerCovariances covariances;  ///< the detector's (px²); zero when it states none
};

/// One frame set of the table; its observations are contiguous.
struct TableFrameSet {
  int rig = 0;      ///< index
  int capture = 0;  ///< index, in canonical order
  Stamp stamp{0};
  int camera = -1;  ///< mono: the camera's number in its capture; −1 for a whole rig
  std::size_t first_observation = 0;
  std::size_t observation_count = 0;
};

/// All observations of a build in one canonical order (captures by fingerprint; frame sets by
/// stamp; observations by camera, marker, corners), so that neither the order of rows nor that of
/// captures nor the number of threads can leave a trace in the result.
struct ObservationTable {
  std::vector<Rig> rigs;                    ///< captures of the same cameras share one
  std::vector<std::string> capture_names;   ///< canonical order
  std::vector<std::size_t> capture_places;  ///< per capture: its place among those given
  std::vector<char> capture_monotonic;      ///< per capture: 1 where stamps count from a start
  /// Captures whose rig.yaml names the same cameras (serials) and states other numbers: their rigs
  /// are kept apart. By name, rising.
  std::vector<std::pair<std::string, std::string>> recalibrated;
  std::vector<std::string> capture_fingerprints;
  std::string rig_fingerprint;         ///< of all different rigs together
  std::vector<MarkerId> markers;       ///< rising
  std::vector<double> stated_sizes_m;  ///< per marker
  std::vector<double> sizes_m;         ///< per marker: effective, what the observations use
  std::vector<double> edge_bias_px;    ///< per camera of all rigs: what corners were moved in by
  std::vector<TableFrameSet> frame_sets;
  std::vector<TableObservation> observations;
  std::vector<std::vector<std::size_t>> observations_of_marker;  ///< per marker, rising
  /// Observations of an id that was found twice in one image; neither can be trusted, none is used.
  int repeated_in_image = 0;
  /// These, as far as they are views of a square, by rising frame set: a finished map may tell
  /// which of them are right.
  std::vector<TableObservation> repeated;
  /// Observations whose corners can't be undistorted or are no front view of a square.
  int degenerate = 0;

  [[nodiscard]] bool several_families() const;
};

/// How captures become a table.
struct TableOptions {
  bool mono = false;  ///< every image a frame of its own, extrinsics unused
  int threads = 0;    ///< for IPPE; 0 = all processors
};

/// Errors: bad_data when two captures state different sizes for one marker, or a rig without
/// extrinsics is used otherwise than mono; usage when there is no capture.
[[nodiscard]] Expected<ObservationTable> make_observation_table(
    std::vector<DetectedCapture> captures, const TableOptions& options);

}  // namespace waymark
