#pragma once

#include <cstdint>
#include <optional>

namespace waymark {

/// Whether messages leave, judged once a second by the count of those that did not.
class LinkWatch {
 public:
  struct News {
    bool raised = true;     ///< some were not taken; false: all of the last second were
    std::int64_t lost = 0;  ///< not taken since it was raised
  };

  /// `failures` since the start; nullopt: all is as before.
  [[nodiscard]] std::optional<News> look(std::int64_t failures) {
    const bool down = failures > seen_;
    if (down && !down_) well_ = seen_;
    seen_ = failures;
    if (down == down_) return std::nullopt;
    down_ = down;
    return News{down, failures - well_};
  }
  [[nodiscard]] bool down() const { return down_; }

 private:
  bool down_ = false;
  std::int64_t seen_ = 0;
  std::int64_t well_ = 0;  ///< failures before it was raised
};

}  // namespace waymark
