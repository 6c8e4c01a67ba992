#include "locd/service/map_edges.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/camera/rig_parameters.h"
#include "core/estimate/consider_parameters.h"

namespace waymark {
namespace {

/// One standard deviation of a parameter, as the map leaves it (px of edges).
std::optional<double> sigma_in(const SubMap& submap, const std::string& name) {
  const auto& all = submap.parameters;
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const MapParameter& one) { return one.name == name; });
  if (found == all.end()) return std::nullopt;
  const auto i = static_cast<Eigen::Index>(found - all.begin());
  return std::sqrt(submap.parameter_covariance(i, i));
}

}  // namespace

std::optional<std::string> note_of_map_edges(const MarkerMap& map, const Rig& rig,
                                             const std::string& map_name) {
  if (map.submaps.empty()) return std::nullopt;
  constexpr double kSurer = 0.5;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const RigCamera& camera = rig.cameras[c];
    if (camera.edge_bias_px) continue;
    const ConsiderParameter edge{.rig = 0, .of_rig = {c, CameraQuantity::edge, 0}};
    const auto in_map = sigma_in(map.submaps.front(), name_of(edge, {&rig, 1}));
    if (!in_map || !(*in_map < kSurer * sigmas_of(camera).edge_px)) continue;
    return fmt::format(
        "{}: the edges that {} sees were measured when it was built; the rig file states none: "
        "give locd the rig file that mapbuilder wrote beside the map (edge_bias_px)",
        map_name, camera.name);
  }
  return std::nullopt;
}

}  // namespace waymark
