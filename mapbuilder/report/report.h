#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/capture/detection.h"
#include "core/map/marker_map.h"
#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/evaluate/ground_truth.h"
#include "mapbuilder/evaluate/pose_accuracy.h"

namespace waymark {

/// A capture that went into the map.
struct ReportCapture {
  std::string name;  ///< as given on the command line; any bytes
  std::string fingerprint;
};

/// A camera whose residuals are told apart.
struct ReportCamera {
  std::string name;  ///< cam0, …; with the capture's name where several rigs have different ones
  int width_px = 0;
  int height_px = 0;
  Eigen::Vector2d principal_point_px = Eigen::Vector2d::Zero();
};

/// What the map leaves of one observation.
struct ReportObservation {
  MarkerId marker;
  std::size_t camera = 0;  ///< index in Report::cameras
  bool accepted = false;   ///< by the gate
  ImageCorners corners_px;
  std::array<Eigen::Vector2d, 4> residuals_px;  ///< observed less predicted
};

/// Where a rig, or one of its cameras, went in one capture.
struct ReportTrack {
  std::string capture;
  std::optional<std::string> camera;     ///< of a mono build: its name
  std::vector<StampedPose> poses;        ///< in the sub-map's world, by rising stamp
  std::vector<StampedPose> true_poses;   ///< carried into the sub-map's world; empty when unknown
  std::optional<PoseRmse> rmse_to_true;  ///< of the capture's poses in this sub-map
};

/// What is told of a sub-map beside its markers.
struct ReportSubMap {
  std::vector<ReportTrack> tracks;
  std::size_t observations = 0;
  std::size_t rejected = 0;
  std::size_t ambiguous = 0;  ///< frame sets left out of the tracks
  double corner_sigma_px = 0;
  bool covariances_known = false;
  std::optional<double> scale_sigma;  ///< of the scale, as a share; calibration considered
  /// Mean of the cameras' upward image directions (−y) in the world; its length is 1 when they
  /// never turned over and 0 when they looked everywhere.
  Eigen::Vector3d camera_up_in_world = Eigen::Vector3d::Zero();
};

/// A measured distance or point against the map.
struct ReportSurveyEntry {
  std::string entry;                 ///< "24 bottom-left to 60 bottom-left", "12 center"
  std::vector<MarkerId> markers;     ///< concerned
  bool is_point = false;             ///< otherwise a distance
  bool check = false;                ///< took no part in the fit
  std::optional<double> measured_m;  ///< a distance as measured
  std::optional<double> mapped_m;    ///< the same in the map
  /// Mapped less measured; of a point the distance between the two. nullopt: a marker is unmapped.
  std::optional<double> residual_m;
  double sigma_m = 0;  ///< stated
};

/// All that a report tells of a build.
struct Report {
  std::string map_name;
  MarkerMap map;
  std::vector<ReportSubMap> submaps;  ///< in the map's order
  std::vector<ReportCapture> captures;
  std::vector<ReportCamera> cameras;
  std::vector<ReportObservation> observations;
  std::vector<ReportSurveyEntry> survey;
  std::vector<Finding> findings;
  std::vector<MarkerId> unmapped;   ///< seen, but no pose could be trusted
  std::size_t unlocalized = 0;      ///< frame sets that see markers but have no pose
  std::size_t without_markers = 0;  ///< frame sets without a usable observation

  /// Whether ids must be written with their family.
  [[nodiscard]] bool several_families() const;
};

}  // namespace waymark
