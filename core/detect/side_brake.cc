#include "core/detect/side_brake.h"

namespace waymark {

void SideBrake::slow(const SideAppearance& from, SideStep& step) {
  // A step that settles comes back by a small part of the last one.
  constexpr double kSwingsBack = 0.5;
  if (step.shift_px.dot(last_px_) < -kSwingsBack * last_px_.squaredNorm()) share_ *= 0.5;
  step.shift_px *= share_;
  last_px_ = step.shift_px;
  if (share_ == 1) return;
  SideAppearance& to = step.appearance;
  const auto go = [&](auto& value, const auto& before) {
    value = before + share_ * (value - before);
  };
  go(to.black_grey, from.black_grey);
  go(to.white_grey, from.white_grey);
  go(to.uneven_grey, from.uneven_grey);
  go(to.paper_end, from.paper_end);
  go(to.blur_px, from.blur_px);
  go(to.bow_px, from.bow_px);
}

}  // namespace waymark
