#include "mapbuilder/calibrate/image_coverage.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace waymark {
namespace {

constexpr int kColumns = 12;
constexpr int kRows = 9;
constexpr int kFewestCorners = 4;

struct Third {
  const char* name;
  const char* remedy;  ///< how the camera gets markers there
};

constexpr std::array<Third, 3> kAcross{{{"left", "turn right until markers stand there"},
                                        {"middle", "turn until markers stand there"},
                                        {"right", "turn left until markers stand there"}}};
constexpr std::array<Third, 3> kDown{{{"upper", "tilt down or come closer"},
                                      {"middle", "tilt until markers stand there"},
                                      {"lower", "tilt up or come closer"}}};

int cell_of(double pixel, int size_px, int cells) {
  const int cell = static_cast<int>((pixel + 0.5) * cells / size_px);
  return std::clamp(cell, 0, cells - 1);
}

void take_empty(const std::array<int, 3>& corners, const std::array<Third, 3>& thirds,
                ImageCoverage& coverage) {
  for (std::size_t i = 0; i < thirds.size(); ++i) {
    if (corners[i] >= kFewestCorners) continue;
    coverage.empty.emplace_back(thirds[i].name);
    coverage.remedies.emplace_back(thirds[i].remedy);
  }
}

}  // namespace

ImageCoverage image_coverage(const std::string& camera, const CameraModel& model,
                             const std::vector<Eigen::Vector2d>& corners_px) {
  ImageCoverage coverage;
  coverage.camera = camera;
  const CameraParameters& p = model.parameters();
  std::array<std::array<char, kColumns>, kRows> seen{};
  std::array<int, 3> across{};
  std::array<int, 3> down{};
  for (const Eigen::Vector2d& corner : corners_px) {
    if (!model.in_image(corner)) continue;
    ++across[static_cast<std::size_t>(cell_of(corner.x(), p.width_px, 3))];
    ++down[static_cast<std::size_t>(cell_of(corner.y(), p.height_px, 3))];
    const int column = cell_of(corner.x(), p.width_px, kColumns);
    const int row = cell_of(corner.y(), p.height_px, kRows);
    for (int r = std::max(0, row - 1); r <= std::min(kRows - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(kColumns - 1, column + 1); ++c) {
        seen[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] = 1;
      }
    }
  }
  int covered = 0;
  for (const auto& row : seen) {
    covered += static_cast<int>(std::count(row.begin(), row.end(), 1));
  }
  coverage.share = covered / static_cast<double>(kColumns * kRows);
  take_empty(across, kAcross, coverage);
  take_empty(down, kDown, coverage);
  return coverage;
}

std::vector<Finding> findings_of(const ImageCoverage& coverage) {
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < coverage.empty.size(); ++i) {
    Finding finding;
    finding.cause = Cause::few_views;
    finding.subject = coverage.camera;
    finding.cameras = {coverage.camera};
    finding.text = fmt::format("no marker in the {} third of {}: its lens is not known there.",
                               coverage.empty[i], coverage.camera);
    finding.remedy = fmt::format("Record more: {}.", coverage.remedies[i]);
    finding.figures = {{"image covered", 100 * coverage.share, "%", {}}};
    findings.push_back(std::move(finding));
  }
  return findings;
}

}  // namespace waymark
