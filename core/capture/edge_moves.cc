#include "core/capture/edge_moves.h"

#include <algorithm>
#include <cmath>

#include "core/camera/rig_parameters.h"
#include "core/marker/marker_outline.h"

namespace waymark {
namespace {

/// To so much numbers are rounded in the file.
constexpr double kRounding_px = 1e-4;

Status check_measured(const RigCamera& camera, const EdgeMeasurement& measured,
                      const std::string& name) {
  if (!camera.edge_bias_px) return {};
  const double off_px = std::abs(*camera.edge_bias_px - measured.bias_px);
  const double sigma_px = std::hypot(measured.sigma_px, camera.stated_sigmas.edge_px.value_or(0));
  if (off_px <= 3 * sigma_px + kRounding_px) return {};
  return fail(ErrorKind::bad_data,
              "{}: stale: {}'s edges were measured as {:+.3f} px when it was written, rig.yaml "
              "states edge_bias_px {:+.3f}; detect again (--redetect), or take one of them away",
              name, camera.name, measured.bias_px, *camera.edge_bias_px);
}

void move_sides_out(const MarkerCatalog& catalog, double px, ImageDetections& image) {
  for (Detection& detection : image.detections) {
    const bool light = catalog.shows_light_squares(detection.marker.family);
    move_sides_in(light ? px : -px, detection.corners);
  }
}

}  // namespace

Status move_edges_on(const Rig& rig, const MarkerCatalog& catalog, const std::string& name,
                     DetectionsTable& table) {
  std::vector<double> onward_px(rig.cameras.size(), 0);
  for (std::size_t c = 0; c < table.moves.size(); ++c) {
    const auto& move = table.moves[c];
    if (!move) continue;
    const RigCamera& camera = rig.cameras[c];
    if (move->measured) {
      if (auto fits = check_measured(camera, *move->measured, name); !fits) return fits;
    } else {
      onward_px[c] = camera.edge_bias_px.value_or(0) - move->px;
    }
  }
  for (ImageDetections& image : table.images) {
    move_sides_out(catalog, onward_px[static_cast<std::size_t>(image.camera)], image);
  }
  return {};
}

std::vector<std::string> widen_for_unknown_moves(const DetectionsTable& table, Rig& rig) {
  std::vector<std::string> widened;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const RigCamera& camera = rig.cameras[c];
    const bool told = c < table.moves.size() && table.moves[c];
    if (told || camera.edge_bias_px.value_or(0) == 0) continue;
    const double sigma_px = std::max(sigmas_of(camera).edge_px, std::abs(*camera.edge_bias_px));
    state_sigma(c, CameraQuantity::edge, sigma_px, rig);
    widened.push_back(camera.name);
  }
  return widened;
}

}  // namespace waymark
