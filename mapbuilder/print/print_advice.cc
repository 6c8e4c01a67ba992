#include "mapbuilder/print/print_advice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/check.h"
#include "core/geometry/degrees.h"
#include "core/marker/marker_layout.h"

namespace waymark {
namespace {

/// Cells are read surely from four pixels on; corners are good to some hundredths of a pixel then.
constexpr double kPixelsPerCell = 4.0;
constexpr double kTurned_rad = std::numbers::pi / 4;
constexpr double kMarkersInView = 4.0;

int cells_of_tag36h11() { return marker_layout(Family::tag36h11).square_cells(); }

/// Angle between the middles of the image's left and right edges; as far as the lens model goes.
double field_of(const CameraModel& camera) {
  const CameraParameters& image = camera.parameters();
  const double middle = 0.5 * (image.height_px - 1);
  double half = 0;
  const auto axis = camera.bearing({image.pu_px, image.pv_px});
  for (const double x : {0.0, image.width_px - 1.0}) {
    const auto bearing = camera.bearing({x, middle});
    half += bearing && axis ? std::acos(std::clamp(bearing->dot(*axis), -1.0, 1.0))
                            : std::numbers::pi / 2;
  }
  return half;
}

}  // namespace

std::vector<PrintAdvice> print_advice(const Rig& rig, double range_m) {
  WAYMARK_CHECK(kAdviceRange_m.contains(range_m));
  std::vector<PrintAdvice> advice;
  for (const RigCamera& camera : rig.cameras) {
    PrintAdvice one;
    one.camera = camera.name;
    one.field_rad = field_of(camera.model);
    const double px_per_rad =
        std::min(camera.model.parameters().fu_px, camera.model.parameters().fv_px);
    const double side_px = kPixelsPerCell * cells_of_tag36h11();
    constexpr double kCentimetre = 0.01;
    const double exact = side_px * range_m / (px_per_rad * std::cos(kTurned_rad));
    one.size_m = kCentimetre * std::ceil(exact / kCentimetre - 1e-9);
    one.readable_m = one.size_m * px_per_rad / side_px;
    // A wall at half the range; of wide fields only what is seen at less than 60° counts.
    const double half = std::min(0.5 * one.field_rad, std::numbers::pi / 3);
    one.spacing_m = range_m * std::tan(half) / kMarkersInView;
    advice.push_back(one);
  }
  return advice;
}

std::string advice_text(const std::vector<PrintAdvice>& advice, double range_m) {
  std::string text;
  double size_m = 0;
  double spacing_m = std::numeric_limits<double>::infinity();
  for (const PrintAdvice& one : advice) {
    text += fmt::format(
        "{}: sees {:.0f}°; tag36h11 of {:.2f} m has {:g} pixels a cell at {:g} m, turned by 45° "
        "(from "
        "the front up to {:.1f} m); one every {:.1f} m of wall keeps four in view at {:g} m\n",
        one.camera, kDegreesPerRadian * one.field_rad, one.size_m, kPixelsPerCell, range_m,
        one.readable_m, one.spacing_m, 0.5 * range_m);
    size_m = std::max(size_m, one.size_m);
    spacing_m = std::min(spacing_m, one.spacing_m);
  }
  text += fmt::format(
      "print: --size-m {:.2f}; hang {:.0f} for every 100 m of wall, at different heights\n", size_m,
      std::ceil(100 / spacing_m));
  return text;
}

}  // namespace waymark
