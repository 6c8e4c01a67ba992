#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/camera/rig.h"
#include "locd/alert.h"
#include "locd/map_index.h"
#include "locd/pose_estimate.h"
#include "locd/robust_pose.h"

namespace waymark {

/// When a camera is said not to stand where the rig file says.
struct CameraWatchOptions {
  double min_turn_rad = 0.005;  ///< smaller ones are calibration's concern, 0.3° (0.05–10°)
  double min_offset_m = 0.010;  ///< likewise (1 mm–1 m)
  double chi2 = 40.0;     ///< of camera alone against the others; 6 degrees of freedom (20–500)
  int sets_to_name = 12;  ///< that tell of it, nine times as many as against it (3–1000)
  double coherent_share = 0.75;  ///< inliers of a set in which nothing is wrong (0.5–1)
};

/// Watches whether the cameras stand to each other as the rig file says. As long as sets are
/// coherent it does nothing but count. In one that is not, the pose by one camera alone is held
/// against the pose by all others (which must agree with one another), and it is asked whether two
/// cameras in each other's place would explain all.
class CameraWatch {
 public:
  CameraWatch(const Rig& rig, const MapIndex& map, const CameraWatchOptions& options = {});

  /// One set: its observations with residuals at its pose.
  void update(Stamp stamp, std::span<const SetObservation> observations,
              std::vector<Alert>& alerts);

  /// Cameras whose outliers tell of markers, not of the camera.
  [[nodiscard]] CameraMask trusted() const;
  /// Cameras that were named and have not been coherent since.
  [[nodiscard]] CameraMask suspects() const;

 private:
  struct Record {
    double inlier_share = 0.5;  ///< running mean over sets
    int sets_off = 0;           ///< alone against the others: elsewhere
    int sets_fine = 0;
    bool named = false;
    AlertKind kind = AlertKind::extrinsics_off;  ///< as what
  };
  struct Sight {  ///< of one camera in one set
    int markers = 0;
    int inliers = 0;
  };
  struct View {  ///< the pose by some cameras
    PoseOptimum optimum;
    int observations = 0;
    int inliers = 0;
  };

  void hold_against_others(Stamp stamp, std::size_t camera,
                           std::span<const SetObservation> observations,
                           std::vector<Alert>& alerts);
  void try_swap(Stamp stamp, std::size_t a, std::size_t b,
                std::span<const SetObservation> observations, std::vector<Alert>& alerts);
  [[nodiscard]] std::optional<View> view_by(std::span<const SetObservation> observations,
                                            CameraMask cameras, std::size_t swap_a,
                                            std::size_t swap_b);
  [[nodiscard]] bool coherent(const View& view) const;
  void name(Stamp stamp, AlertKind kind, int camera, int other, const Vector6d& offset,
            std::vector<Alert>& alerts);
  void clear(Stamp stamp, std::size_t camera, std::vector<Alert>& alerts);

  const MapIndex& map_;
  CameraWatchOptions options_;
  std::size_t cameras_;
  RigPoseSolver solver_;
  std::array<Record, kMaxCameras> records_;
  std::array<Sight, kMaxCameras> sights_;
  std::vector<int> swap_sets_;  ///< per pair: sets that it explains
  std::size_t turn_ = 0;        ///< which camera or pair is asked next
  std::vector<MarkerObservation> scratch_;
  std::vector<FixedMarkerObservation> fixed_;
};

}  // namespace waymark
