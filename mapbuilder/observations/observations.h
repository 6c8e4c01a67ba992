#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "mapbuilder/observations/detected_capture.h"
#include "mapbuilder/observations/typed_index.h"

namespace waymark {

using RigIndex = Index<struct RigKind>;
using CameraIndex = Index<struct CameraKind>;  ///< over the cameras of all rigs
using CaptureIndex = Index<struct CaptureKind>;
using FrameSetIndex = Index<struct FrameSetKind>;
using MarkerIndex = Index<struct MarkerKind>;
using ObservationIndex = Index<struct ObservationKind>;

/// A marker as it was found in one image.
struct Observation {
  FrameSetIndex frame_set;
  CameraIndex camera;
  MarkerIndex marker;
  ImageCorners corners_px;
  CornerCovariances covariances;  ///< the detector's (px²); zero when it states none
};

/// Images of one instant.
struct ObservedFrameSet {
  RigIndex rig;
  CaptureIndex capture;
  Stamp stamp{0};
  std::optional<int> mono_camera;             ///< mono: the camera's number in its capture
  IndexRange<ObservationIndex> observations;  ///< usable ones
};

/// One of the captures that the observations come from.
struct ObservedCapture {
  std::string name;
  std::string fingerprint;
  std::size_t place = 0;   ///< among those given
  bool monotonic = false;  ///< its stamps count from a start that no other capture shares
};

/// Where a camera stands in its rig.
struct CameraPlace {
  RigIndex rig;
  std::size_t in_rig = 0;
};

/// All that was seen, as it was seen: made once, in one canonical order (captures by fingerprint;
/// frame sets by stamp; observations by camera, marker, corners), so that neither the order of rows
/// nor that of captures nor the number of threads can leave a trace in the result. Nothing changes
/// it afterwards: a subset is a list of indices (Selection), a correction is data beside it
/// (Estimate).
struct Observations {
  IndexedVector<RigIndex, Rig> rigs;  ///< as stated; captures of the same cameras share one
  IndexedVector<CameraIndex, CameraPlace> cameras;
  IndexedVector<RigIndex, CameraIndex> first_camera;
  /// A camera's edges where every one of its captures has measured them.
  IndexedVector<CameraIndex, std::optional<EdgeMeasurement>> edges;
  IndexedVector<CaptureIndex, ObservedCapture> captures;
  /// Captures whose rig.yaml names the same cameras (serials) and states other numbers: their rigs
  /// are kept apart. By name, rising.
  std::vector<std::pair<std::string, std::string>> recalibrated;
  std::string rig_fingerprint;                        ///< of all different rigs together
  IndexedVector<MarkerIndex, MarkerId> markers;       ///< rising
  IndexedVector<MarkerIndex, double> stated_sizes_m;  ///< by markers.toml
  IndexedVector<MarkerIndex, double> size_sigmas;     ///< how sure these are, as a share of them
  IndexedVector<MarkerIndex, std::string> groups;     ///< what moves together; empty: not stated
  IndexedVector<FrameSetIndex, ObservedFrameSet> frame_sets;
  /// The usable ones, then those of an id that was found twice in one image: neither of the two can
  /// be trusted, but a finished map may tell which of them is right. Both by rising frame set.
  IndexedVector<ObservationIndex, Observation> all;
  std::size_t usable = 0;
  std::size_t repeated_in_image = 0;  ///< of an id that was found twice in one image
  /// Whose corners can't be undistorted or are no front view of a square; left out.
  std::size_t degenerate = 0;
  /// Per camera: with corners where its calibration says nothing (CameraModel::covers); left out.
  IndexedVector<CameraIndex, std::size_t> beyond_calibration;

  [[nodiscard]] const Observation& operator[](ObservationIndex index) const { return all[index]; }
  /// Whether anything usable was seen, be it left out.
  [[nodiscard]] bool any_seen() const {
    return !all.empty() || degenerate > 0 ||
           std::any_of(beyond_calibration.begin(), beyond_calibration.end(),
                       [](std::size_t count) { return count > 0; });
  }
  [[nodiscard]] bool several_families() const {
    MeetingFamilies families;
    for (const MarkerId& id : markers) families.add(id.family);
    return families.several();
  }
  /// Number of the observation's camera in its rig.
  [[nodiscard]] std::size_t camera_in_rig(const Observation& o) const {
    return cameras[o.camera].in_rig;
  }
};

/// How captures become observations.
struct ObservationOptions {
  bool mono = false;  ///< every image a frame of its own, extrinsics unused
  int threads = 0;    ///< for IPPE; 0 = all processors
};

/// Errors: bad_data when two captures state different sizes for one marker, or a rig without
/// extrinsics is used otherwise than mono; usage when there is no capture, or one is named twice.
[[nodiscard]] Expected<Observations> make_observations(const std::vector<DetectedCapture>& captures,
                                                       const ObservationOptions& options);

}  // namespace waymark
