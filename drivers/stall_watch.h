#pragma once

#include "core/geometry/stamp.h"

namespace waymark {

/// Whether a stream that should deliver frames has stalled: none for five periods and two seconds.
class StallWatch {
 public:
  /// A stream of `fps` frames per second begins; 0: not known, one a second at least.
  void begin(Stamp now, double fps) {
    const Stamp period =
        fps > 0 ? Stamp(static_cast<Stamp::rep>(1e9 / fps)) : Stamp(std::chrono::seconds(1));
    patience_ = std::chrono::seconds(2) + 5 * period;
    last_frame_ = now;
  }
  /// A whole frame came.
  void frame(Stamp now) { last_frame_ = now; }

  [[nodiscard]] bool stalled(Stamp now) const { return now - last_frame_ > patience_; }
  [[nodiscard]] Stamp patience() const { return patience_; }

 private:
  Stamp patience_{0};
  Stamp last_frame_{0};
};

}  // namespace waymark
