#include "locd/frames/set_pacer.h"

#include <algorithm>

namespace waymark {

bool SetPacer::admit(Stamp set_stamp) {
  const Stamp gap = set_stamp - last_;
  // A gap of many periods is cameras coming back, not a slower rig.
  if (has_last_ && gap > Stamp{0} && (period_ == Stamp{0} || gap < 8 * period_)) {
    period_ = period_ == Stamp{0} ? gap : period_ + (gap - period_) / 16;
  }
  has_last_ = true;
  last_ = set_stamp;
  if (++since_taken_ < divisor_) {
    ++skipped_;
    return false;
  }
  since_taken_ = 0;
  return true;
}

void SetPacer::finished(Stamp duration) {
  durations_[count_++ % kWindow] = duration;
  if (count_ >= kWindow / 2) judge();
}

void SetPacer::judge() {
  if (period_ == Stamp{0}) return;
  std::array<Stamp, kWindow> sorted = durations_;
  const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(std::min(count_, kWindow));
  const auto percentile = end - 2;
  std::nth_element(sorted.begin(), percentile, end);
  const double load = static_cast<double>(percentile->count()) /
                      static_cast<double>(period_.count());  // periods that one set takes
  const auto fits = [&](int divisor, double part) { return load <= part * divisor; };
  int next = divisor_;
  while (next < kMaxDivisor && !fits(next, kBusy)) ++next;
  // Down again only on a whole window's word.
  if (next == divisor_ && count_ >= kWindow && next > 1 && fits(next - 1, kIdle)) --next;
  if (next == divisor_) return;
  divisor_ = next;
  count_ = 0;
}

}  // namespace waymark
