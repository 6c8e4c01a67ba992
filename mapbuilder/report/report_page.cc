#include "mapbuilder/report/report_page.h"

#include <nlohmann/json.hpp>

#include "core/map/json_value.h"
#include "mapbuilder/report/page_template.h"
#include "mapbuilder/report/plan_view.h"
#include "mapbuilder/report/residual_statistics.h"
#include "mapbuilder/report/summary_json.h"

namespace waymark {
namespace {

using nlohmann::ordered_json;

/// More points than these no screen can show; longer tracks are thinned.
constexpr std::size_t kMostPoses = 20'000;

/// Upper triangle of a symmetric 3×3, row by row.
ordered_json triangle_json(const Eigen::Matrix3d& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)};
}

/// [[seconds since the first pose, x, y, z], …], the last pose always among them.
ordered_json poses_json(const std::vector<StampedPose>& poses, Stamp from) {
  ordered_json json = ordered_json::array();
  const std::size_t step = poses.size() / kMostPoses + 1;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i % step != 0 && i + 1 != poses.size()) continue;
    const std::chrono::duration<double> time = poses[i].stamp - from;
    const Eigen::Vector3d& p = poses[i].pose.translation;
    // Microseconds and tenths of a millimetre: finer than any screen.
    const auto rounded = [](double value, double unit) { return std::round(value / unit) * unit; };
    json.push_back({nine_decimals(rounded(time.count(), 1e-6)), nine_decimals(rounded(p.x(), 1e-4)),
                    nine_decimals(rounded(p.y(), 1e-4)), nine_decimals(rounded(p.z(), 1e-4))});
  }
  return json;
}

ordered_json scene_json(const SubMap& submap, const ReportSubMap& told) {
  const PlanView view = plan_view(submap, told.camera_up_in_world);
  const Eigen::Quaterniond& q = view.plan_from_world;
  ordered_json tracks = ordered_json::array();
  for (const ReportTrack& track : told.tracks) {
    const Stamp from = track.poses.empty() ? Stamp{0} : track.poses.front().stamp;
    tracks.push_back({{"poses", poses_json(track.poses, from)},
                      {"true_poses", poses_json(track.true_poses, from)}});
  }
  ordered_json covariances = ordered_json::array();
  if (told.covariances_known) {
    for (const MapMarker& marker : submap.markers) {
      covariances.push_back(triangle_json(marker.covariance.topLeftCorner<3, 3>()));
    }
  }
  return {{"plan_from_world_xyzw", {q.x(), q.y(), q.z(), q.w()}},
          {"z_is_up", view.z_is_up},
          {"tracks", std::move(tracks)},
          {"position_covariances_m2", std::move(covariances)}};
}

/// The mean residuals over each camera's image: [[corners, mean x, mean y], …] row by row.
ordered_json grids_json(const Report& report) {
  ordered_json grids = ordered_json::array();
  for (const CameraResiduals& camera :
       residual_statistics(report.observations, report.cameras).by_camera) {
    ordered_json cells = ordered_json::array();
    for (const ImageCell& cell : camera.cells) {
      cells.push_back(
          {cell.corners, nine_decimals(cell.mean_px.x()), nine_decimals(cell.mean_px.y())});
    }
    grids.push_back(
        {{"columns", camera.columns}, {"rows", camera.rows}, {"cells", std::move(cells)}});
  }
  return grids;
}

/// JSON that no HTML parser can take for markup: '<' only ever stands within strings.
std::string inline_text(const ordered_json& json) {
  std::string text;
  for (const char c : json_text(json)) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace

std::string format_report_page(const Report& report) {
  ordered_json scene = ordered_json::array();
  for (std::size_t i = 0; i < report.submaps.size(); ++i) {
    scene.push_back(scene_json(report.map.submaps[i], report.submaps[i]));
  }
  std::string page;
  for (const std::string_view part : page_before_data()) page += part;
  page += inline_text({{"summary", summary_json(report)},
                       {"scene", std::move(scene)},
                       {"image_grids", grids_json(report)}});
  for (const std::string_view part : page_after_data()) page += part;
  return page;
}

}  // namespace waymark
