#include "locd/publish/status_text.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <iterator>

#include "core/geometry/degrees.h"
#include "locd/pose/pose_gate.h"

namespace waymark {
namespace {

using Text = fmt::basic_memory_buffer<char, kMostStatusText>;

constexpr std::array<const char*, 4> kStatus = {"OK", "DEGRADED", "AMBIGUOUS", "LOST"};

/// What each reason says, in the order of their bits; of those with a figure or a name see
/// words_of.
constexpr std::array<const char*, kPoseReasons> kWords = {"no frames",
                                                          "no map",
                                                          "no mapped marker seen",
                                                          "no pose explains what is seen",
                                                          "another pose explains it too",
                                                          "",
                                                          "one marker",
                                                          "jumped farther than it can drive",
                                                          "",
                                                          "velocity not known yet",
                                                          "cameras not exposed together",
                                                          "stamps not believed",
                                                          "",
                                                          "a camera is in doubt",
                                                          "too slow for all frame sets",
                                                          "what is seen contradicts itself",
                                                          "markers are not where the map says",
                                                          ""};

void append_missing(const PoseEstimate& estimate, Text& text) {
  const char* between = "";
  for (std::size_t c = 0; c < kMaxCameras; ++c) {
    if (((estimate.cameras_expected & ~estimate.cameras_in_set) & camera_bit(c)) == 0) continue;
    fmt::format_to(std::back_inserter(text), "{}cam{}", between, c);
    between = ", ";
  }
  fmt::format_to(std::back_inserter(text), "{}",
                 *between == 0 ? "a camera's image unusable" : " missing");
}

void append_words(const PoseEstimate& estimate, PoseReason reason, Text& text) {
  const auto out = std::back_inserter(text);
  switch (reason) {
    case PoseReason::sigma: {
      const PoseSigmas sigmas = worst_sigmas(estimate.covariance);
      fmt::format_to(out, "sure to {:.0f} mm and {:.2f} deg only", 1e3 * sigmas.position_m,
                     kDegreesPerRadian * sigmas.rotation_rad);
      break;
    }
    case PoseReason::protection:
      fmt::format_to(out, "protected to {:.0f} mm and {:.2f} deg only",
                     1e3 * estimate.protection.horizontal_m,
                     kDegreesPerRadian * estimate.protection.rotation_rad);
      break;
    case PoseReason::camera_missing:
      append_missing(estimate, text);
      break;
    case PoseReason::outliers:
      fmt::format_to(out, "{} of {} observations disagree", estimate.outliers,
                     estimate.outliers + estimate.observations_used);
      break;
    default:
      fmt::format_to(out, "{}", kWords.at(static_cast<std::size_t>(std::countr_zero(bit(reason)))));
  }
}

}  // namespace

void write_status_text(const PoseEstimate& estimate, std::string& text) {
  Text words;
  const auto out = std::back_inserter(words);
  fmt::format_to(out, "{}", kStatus.at(static_cast<std::size_t>(estimate.status)));
  if (estimate.status == PoseStatus::ok) {
    fmt::format_to(out, ", {} marker{}, {:.0f} mm", estimate.markers_used,
                   estimate.markers_used == 1 ? "" : "s",
                   1e3 * worst_sigmas(estimate.covariance).position_m);
  }
  const char* between = ": ";
  for (std::size_t b = 0; b < kPoseReasons; ++b) {
    const auto reason = static_cast<PoseReason>(1U << b);
    if (!estimate.has(reason)) continue;
    fmt::format_to(out, "{}", between);
    append_words(estimate, reason, words);
    between = ", ";
  }
  text.assign(words.data(), words.size());
}

}  // namespace waymark
