#include "core/base/progress.h"

#include <fmt/ostream.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>

namespace waymark {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

constexpr auto kTerminalInterval = milliseconds(100);
constexpr auto kLogInterval = seconds(5);
constexpr std::size_t kBarWidth = 30;

}  // namespace

Progress::Progress(bool enabled) : enabled_(enabled), terminal_(::isatty(STDERR_FILENO) == 1) {}

void Progress::begin(const std::string& stage, std::size_t total) {
  end();
  stage_ = stage;
  note_.clear();
  total_ = total;
  done_ = 0;
  started_ = drawn_ = steady_clock::now();
  running_ = true;
}

void Progress::update(std::size_t done, const std::string& note) {
  done_ = done;
  note_ = note;
  const auto now = steady_clock::now();
  if (!enabled_ || now - drawn_ < (terminal_ ? milliseconds(kTerminalInterval) : kLogInterval)) {
    return;
  }
  drawn_ = now;
  draw(false);
}

void Progress::end() {
  if (!running_) return;
  running_ = false;
  if (enabled_ && (terminal_ || steady_clock::now() - started_ >= kLogInterval)) draw(true);
}

void Progress::draw(bool last) {
  const double elapsed_s = std::chrono::duration<double>(steady_clock::now() - started_).count();
  std::string count = total_ > 0 ? fmt::format("{}/{}", done_, total_) : fmt::format("{}", done_);
  if (!terminal_) {
    fmt::print(std::cerr, "{}: {}{}{}, {:.0f} s\n", stage_, count, note_.empty() ? "" : ", ", note_,
               elapsed_s);
    return;
  }
  const std::size_t filled =
      total_ > 0 ? std::min(kBarWidth, kBarWidth * done_ / total_) : std::size_t{0};
  fmt::print(std::cerr, "\r\033[K{} [{}{}] {} {:.1f} s {}{}", stage_, std::string(filled, '#'),
             std::string(kBarWidth - filled, '.'), count, elapsed_s, note_, last ? "\n" : "");
  std::cerr.flush();
}

}  // namespace waymark
