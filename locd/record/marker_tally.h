#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "locd/pose/pose_estimate.h"

namespace waymark {

/// Which markers a recording has seen, and how often from another place: whether it is worth
/// building a map of. A view counts when the marker has moved by half of its side in a camera's
/// image since the last view that counted there, or another camera sees it: who stands still makes
/// one view. Plain memory, all of it taken when it is made; counting allocates nothing.
class MarkerTally {
 public:
  /// Markers that are told apart; of more, only that there are.
  static constexpr std::size_t kMostMarkers = 4096;

  explicit MarkerTally(std::size_t most = kMostMarkers);

  void clear();
  /// Counts what was found in one frame set, what is ignored apart.
  void count(const PoseEstimate& estimate);

  [[nodiscard]] std::size_t markers() const { return seen_.size(); }
  /// Markers of one view, by rising id.
  [[nodiscard]] std::vector<MarkerId> seen_once() const;
  /// "97 markers, 4 seen once: pass 31, 44, 58, 60 again"; "no marker was seen: …" with what to do.
  [[nodiscard]] std::string verdict() const;

 private:
  struct Seen {
    MarkerId marker;
    int views = 0;
    std::int16_t camera = 0;  ///< of the last view that counted
    Eigen::Vector2d center_px = Eigen::Vector2d::Zero();
  };
  void count(const ObservedMarker& seen);

  std::vector<Seen> seen_;  ///< by rising id
  std::size_t most_;
  bool more_ = false;
};

}  // namespace waymark
