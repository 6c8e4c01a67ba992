#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace waymark {

/// Shows on stderr how far a long stage is: a bar that redraws itself on a terminal, a line per 5 s
/// otherwise, and a line with the time when the stage ends after 5 s or more. Not for use from
/// several threads.
class Progress {
 public:
  /// `enabled` false: prints nothing (tests).
  explicit Progress(bool enabled = true);

  /// Begins a stage of `total` steps (0: unknown).
  void begin(const std::string& stage, std::size_t total);
  /// `done` steps of the stage are done; `note` is shown behind.
  void update(std::size_t done, const std::string& note = "");
  void end();

 private:
  void draw(bool last);

  bool enabled_;
  bool terminal_;
  bool running_ = false;
  std::string stage_;
  std::string note_;
  std::size_t total_ = 0;
  std::size_t done_ = 0;
  std::chrono::steady_clock::time_point started_;
  std::chrono::steady_clock::time_point drawn_;
};

}  // namespace waymark
