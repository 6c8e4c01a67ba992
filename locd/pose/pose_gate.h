#pragma once

#include <optional>

#include "core/base/range.h"
#include "locd/pose/motion_filter.h"
#include "locd/pose/pose_estimate.h"
#include "locd/pose/robust_pose.h"

namespace waymark {

/// What OK means.
struct GateOptions {
  double max_3sigma_m = 0.020;      ///< along the worst direction
  double max_3sigma_rad = 0.00873;  ///< 0.5°, about the worst axis
  double max_protection_m = 0;      ///< horizontal protection level; 0: not asked for
  double max_protection_rad = 0;    ///< that of the rotation; 0: not asked for
  double v_max_mps = 3.0;           ///< the vehicle is never faster
  double w_max_radps = 2.1;         ///< 120°/s: it never turns faster
  /// A prior that is surer than so many times the limits may vouch for a single marker.
  double vouching_factor = 2.0;
  /// A pose in another place is taken to be true when so many sets in a row go on from it; a twin
  /// of a place is passed sooner. (2–1000)
  int sets_to_believe_jump = 50;

  static constexpr Range kMax3Sigma_m{0.001, 1};
  static constexpr Range kMax3Sigma_deg{0.01, 10};
  static constexpr Range kMaxProtection_m{0, 100};
  static constexpr Range kMaxProtection_deg{0, 180};
  static constexpr Range kVMax_mps{0.1, 100};
  static constexpr Range kWMax_degps{1, 10'000};
  static constexpr Range kVouchingFactor{1, 10};
  static constexpr Range kSetsToBelieveJump{2, 1000};
  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Largest standard deviation of a pose's position (m) and about any axis (rad).
struct PoseSigmas {
  double position_m = 0;
  double rotation_rad = 0;
};
[[nodiscard]] PoseSigmas worst_sigmas(const Matrix6d& covariance);

/// Whether `delta` is one that its covariance allows: χ² of 6 degrees of freedom at 99.9 %.
[[nodiscard]] bool agrees(const Vector6d& delta, const Matrix6d& covariance);

/// Tells what is wrong with a solution. Remembers where the rig was.
class PoseGate {
 public:
  /// The options are valid (checked).
  explicit PoseGate(const GateOptions& options);

  /// Reasons against the solution, 0 for none; of few_markers, sigma, ambiguous, jump, outliers.
  [[nodiscard]] ReasonBits judge(Stamp stamp, const PoseSolution& solution,
                                 const std::optional<MotionPrediction>& prior);

  /// protection, where levels are beyond the limits; 0 where they are not or nobody asked.
  [[nodiscard]] ReasonBits judge(const Protection& protection) const;

  /// A gap: any place may be next.
  void forget() {
    place_.reset();
    elsewhere_.reset();
  }
  /// How often the rig was found anew, after a gap or a jump: a step there is no motion.
  [[nodiscard]] int resets() const { return resets_; }

 private:
  struct Place {
    Stamp stamp{0};
    Rigid3 pose;
    PoseSigmas sigmas;
  };
  [[nodiscard]] bool reachable(const Place& from, const Place& to) const;
  /// Whether the rig can't be at `here`, by where it was.
  [[nodiscard]] bool jumped(const Place& here);
  /// Where it would be now, had it not jumped.
  [[nodiscard]] Place expected(const Place& here) const;
  void settle(const Place& here, bool anew);

  GateOptions options_;
  std::optional<Place> place_;
  /// Where it is said to have jumped to, and to have gone from there. Motion is the same in both
  /// places: it tells where the rig would be if it had not jumped.
  std::optional<Place> elsewhere_;
  Rigid3 place_from_elsewhere_;
  int sets_elsewhere_ = 0;
  bool known_ = false;  ///< it was anywhere before
  int resets_ = 0;
};

}  // namespace waymark
