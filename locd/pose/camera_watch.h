#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/base/range.h"
#include "core/camera/rig.h"
#include "locd/alert.h"
#include "locd/pose/corner_noise.h"
#include "locd/pose/map_index.h"
#include "locd/pose/pose_estimate.h"
#include "locd/pose/robust_pose.h"
#include "locd/pose/whitened_residual.h"

namespace waymark {

/// When a camera is said not to stand where the rig file says.
struct CameraWatchOptions {
  double min_turn_rad = 0.005;  ///< smaller ones are calibration's concern, 0.3° (0.001–0.2)
  double min_offset_m = 0.020;  ///< likewise (1 mm–1 m)
  double chi2 = 80.0;  ///< of either against its own covariance, 3 degrees of freedom (20–1000)
  double memory_sets = 100;    ///< residuals are summed over so many (10–1000)
  int min_sets = 15;           ///< that two cameras saw, before anything is said (3–1000)
  double clear_margin = 1.05;  ///< of χ² explained, over the second best (1–10)
  int sets_to_decide = 70;  ///< after so many the best is named without margin (min_sets–10000)
  double trusted_share = 0.7;    ///< of a camera's markers that must fit, on average (0.5–1)
  int swap_sets = 6;             ///< that only a swap explains, to name it (2–1000)
  int right_sets = 20;           ///< in which both agree with the others, to end it (2–1000)
  double coherent_share = 0.75;  ///< inliers of a set in which nothing is wrong (0.5–1)

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Watches whether the cameras stand to each other as the rig file says. In each set, each camera's
/// markers are fitted by themselves; where the cameras' own poses differ from one another, always
/// in the same way as seen from the rig, one of them does not stand where it should: the one whose
/// displacement explains most. Where most markers of a set are outliers, exchanging two cameras is
/// tried as an explanation. Either alert ends when the cameras agree again.
class CameraWatch {
 public:
  /// The options are valid (checked).
  CameraWatch(const Rig& rig, const MapIndex& map, const CameraWatchOptions& options = {});

  /// One set: its observations with residuals at its pose.
  void update(Stamp stamp, std::span<const SetObservation> observations,
              const Rigid3& world_from_rig, std::vector<Alert>& alerts);

  /// What the cameras' markers left in the last set when fitted camera by camera.
  [[nodiscard]] std::span<const CornerNoise::CameraResiduals> own_residuals() const {
    return {own_residuals_.data(), own_count_};
  }

  /// Cameras whose outliers are due to their markers, not to the camera itself.
  [[nodiscard]] CameraMask trusted() const;
  /// Cameras that were named and have not been right since.
  [[nodiscard]] CameraMask suspects() const;

 private:
  /// A camera's own fit in one set: the normal equations of the rig's displacement in rig axes.
  struct OwnFit {
    Matrix6d information = Matrix6d::Zero();
    Vector6d evidence = Vector6d::Zero();
    int markers = 0;
    int inliers = 0;        ///< of the set's pose
    bool summable = false;  ///< two markers at least, and not far from the set's pose
  };
  struct Record {
    double inlier_share = 0.5;                ///< running mean over sets
    Matrix6d information = Matrix6d::Zero();  ///< of the camera's displacement, the others given
    Vector6d evidence = Vector6d::Zero();
    int sets = 0;
    bool named = false;
    AlertKind kind = AlertKind::extrinsics_off;  ///< as what
    std::size_t partner = 0;                     ///< where it is named as swapped
    int right_sets = 0;  ///< since it was named as swapped, in which it agrees with another
  };
  struct CameraPair {
    std::size_t a = 0;
    std::size_t b = 0;
    int sets = 0;  ///< that only their swap explains
  };
  struct Displacement {
    Vector6d offset = Vector6d::Zero();
    double explained = 0;      ///< χ² that it takes away
    bool significant = false;  ///< large enough to be named
    bool small = false;        ///< small enough to end what was said of the camera
  };

  void fit_camera(std::size_t camera, std::span<const SetObservation> observations,
                  const Rigid3& world_from_rig);
  void sum_displacements();
  [[nodiscard]] Displacement displacement(const Record& record) const;
  void judge_displacements(Stamp stamp, std::vector<Alert>& alerts);
  void look_for_swaps_that_ended(Stamp stamp, bool coherent, std::vector<Alert>& alerts);
  [[nodiscard]] bool may_be_swapped(const CameraPair& pair) const;
  void look_for_swap(Stamp stamp, std::span<const SetObservation> observations,
                     std::vector<Alert>& alerts);
  [[nodiscard]] bool coherent_when_swapped(std::span<const SetObservation> observations,
                                           std::size_t a, std::size_t b);
  void raise(Stamp stamp, AlertKind kind, std::size_t camera, int other, const Vector6d& offset,
             std::vector<Alert>& alerts);
  void end_verdict(Stamp stamp, std::size_t camera, std::vector<Alert>& alerts);

  const MapIndex& map_;
  CameraWatchOptions options_;
  std::size_t cameras_;
  RigPoseSolver solver_;
  std::array<Record, kMaxCameras> records_;
  std::array<OwnFit, kMaxCameras> fits_;
  std::array<CornerNoise::CameraResiduals, kMaxCameras> own_residuals_;
  std::size_t own_count_ = 0;
  std::vector<WhitenedResidual> whitened_;  ///< of one camera
  std::vector<double> squared_;
  std::vector<CameraPair> pairs_;
  std::size_t asked_pair_ = 0;  ///< the next set is asked about it
  std::vector<MarkerObservation> scratch_;
  std::vector<FixedMarkerObservation> fixed_;
};

}  // namespace waymark
