#pragma once

#include "core/detect/side_fit.h"

namespace waymark {

/// Shortens the steps of a side that swings. Where white is saturated and no pixel lies between it
/// and black, a Gauss–Newton step leaps over the place that it seeks, and the next one back, for
/// ever: each time, the side goes half as far from then on. Steps that settle are left as they are.
class SideBrake {
 public:
  /// `from` is what the side looked like before the step.
  void slow(const SideAppearance& from, SideStep& step);

 private:
  double share_ = 1;  ///< of a step that is gone
  Eigen::Vector2d last_px_ = Eigen::Vector2d::Zero();
};

}  // namespace waymark
