#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/base/range.h"
#include "core/camera/camera_sigmas.h"
#include "core/marker/family.h"
#include "locd/frames/image_health.h"
#include "locd/frames/skew_watch.h"
#include "locd/pose/motion_filter.h"
#include "locd/pose/pose_gate.h"

namespace waymark {

/// How frame sets become poses.
struct LocalizerOptions {
  GateOptions gate;
  double prior_max_age_s = 0.5;  ///< older poses predict nothing
  /// Exposures farther apart need the rig's velocity to be put together; on a triggered rig they
  /// must not occur.
  Stamp negligible_skew = std::chrono::microseconds(1000);
  bool triggered = false;  ///< the rig's cameras expose together: skew is a fault
  /// Cameras that ran before the program did: see ImageHealthOptions. A capture's first images are
  /// as good as any.
  bool doubt_first_images = false;
  /// What the calibration errs by, within what is stated, is learnt while the rig moves.
  bool online_calibration = true;
  std::vector<Family> inverted;  ///< families that are printed white for black
  /// Look for markers where the prediction has them, and in the whole images by turns.
  bool guided = true;
  Eigen::Vector3d protected_point_in_rig =
      Eigen::Vector3d::Zero();  ///< whose position levels bound
  int detection_threads = 0;    ///< 0: one per camera, at most as many as there are processors
  /// Called by each detection worker when it begins: its name, its priority. Empty: nothing.
  std::function<void()> begin_worker;

  static constexpr Range kPriorMaxAge_s = MotionOptions::kMaxAge_s;
  static constexpr Range kNegligibleSkew_ms = SkewWatchOptions::kMost_ms;
  static constexpr Range kDetectionThreads{0, kMaxCameras};
  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;

  /// What the parts of a localizer are to be made with.
  [[nodiscard]] SigmaCircumstances circumstances() const;
  [[nodiscard]] MotionOptions motion() const;
  [[nodiscard]] ImageHealthOptions image_health() const;
};

}  // namespace waymark
