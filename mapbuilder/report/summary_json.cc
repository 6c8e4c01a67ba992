#include "mapbuilder/report/summary_json.h"

#include <cmath>
#include <numbers>

#include "core/base/check.h"
#include "core/map/json_value.h"
#include "core/map/map_file.h"
#include "core/map/map_json.h"
#include "mapbuilder/report/residual_statistics.h"

namespace waymark {
namespace {

using nlohmann::ordered_json;

template <typename Vector>
ordered_json vector_json(const Vector& vector) {
  ordered_json json = ordered_json::array();
  for (const double value : vector) json.push_back(nine_decimals(value));
  return json;
}

ordered_json number_or_null(const std::optional<double>& value) {
  return value ? ordered_json(nine_decimals(*value)) : ordered_json(nullptr);
}

ordered_json ids_json(const std::vector<MarkerId>& ids, bool with_family) {
  ordered_json json = ordered_json::array();
  for (const MarkerId& id : ids) json.push_back(json_of(id, with_family));
  return json;
}

ordered_json finding_json(const Finding& finding, bool with_family) {
  ordered_json figures = ordered_json::array();
  for (const Figure& figure : finding.figures) {
    ordered_json json{
        {"name", figure.name}, {"value", nine_decimals(figure.value)}, {"unit", figure.unit}};
    if (figure.sigma) json["sigma"] = nine_decimals(*figure.sigma);
    figures.push_back(std::move(json));
  }
  ordered_json value = nullptr;
  ordered_json sigma = nullptr;
  ordered_json unit = nullptr;
  if (!finding.figures.empty()) {
    const Figure& first = finding.figures.front();
    value = nine_decimals(first.value);
    sigma = number_or_null(first.sigma);
    unit = first.unit;
  }
  return {{"severity", name_of(finding.severity)},
          {"cause", name_of(finding.cause)},
          {"subject", finding.subject},
          {"value", std::move(value)},
          {"sigma", std::move(sigma)},
          {"unit", std::move(unit)},
          {"explains", finding.explains},
          {"text", finding.text},
          {"remedy", finding.remedy},
          {"markers", ids_json(finding.markers, with_family)},
          {"cameras", finding.cameras},
          {"captures", finding.captures},
          {"submap", finding.submap ? ordered_json(*finding.submap) : ordered_json(nullptr)},
          {"figures", std::move(figures)}};
}

ordered_json marker_json(const MapMarker& marker, bool covariances_known, bool with_family) {
  ordered_json sigma_m = nullptr;
  ordered_json sigma_deg = nullptr;
  ordered_json sigma_metric_m = nullptr;
  if (covariances_known && marker.covariance_known()) {
    const Vector6d variances = marker.covariance.diagonal().cwiseMax(0.0);
    sigma_m = nine_decimals(std::sqrt(variances.head<3>().sum()));
    sigma_deg = nine_decimals(std::sqrt(variances.tail<3>().sum()) * 180 / std::numbers::pi);
    sigma_metric_m = nine_decimals(std::sqrt(marker.metric().topLeftCorner<3, 3>().trace()));
  }
  const Rigid3& pose = marker.world_from_marker;
  return {{"id", json_of(marker.id, with_family)},
          {"family", name_of(marker.id.family)},
          {"size_m", nine_decimals(marker.size_m)},
          {"stated_size_m", nine_decimals(marker.stated_size_m)},
          {"position_m", vector_json(pose.translation)},
          {"quaternion_xyzw", vector_json(pose.rotation.coeffs())},
          {"sigma_position_m", std::move(sigma_m)},
          {"sigma_rotation_deg", std::move(sigma_deg)},
          {"sigma_metric_position_m", std::move(sigma_metric_m)},
          {"observations", marker.observations},
          {"rejected", marker.rejected},
          {"rms_px", nine_decimals(marker.rms_px)},
          {"verified", marker.verified}};
}

ordered_json track_json(const ReportTrack& track) {
  ordered_json json{{"capture", track.capture},
                    {"camera", track.camera ? ordered_json(*track.camera) : ordered_json(nullptr)},
                    {"poses", track.poses.size()},
                    {"true_poses", track.true_poses.size()},
                    {"translation_rmse_m", nullptr},
                    {"rotation_rmse_deg", nullptr}};
  if (track.rmse_to_true) {
    json["translation_rmse_m"] = nine_decimals(track.rmse_to_true->translation_m);
    json["rotation_rmse_deg"] =
        nine_decimals(track.rmse_to_true->rotation_rad * 180 / std::numbers::pi);
  }
  return json;
}

ordered_json submap_json(const SubMap& submap, const ReportSubMap& told, bool with_family) {
  ordered_json markers = ordered_json::array();
  for (const MapMarker& marker : submap.markers) {
    markers.push_back(marker_json(marker, told.covariances_known, with_family));
  }
  ordered_json tracks = ordered_json::array();
  for (const ReportTrack& track : told.tracks) tracks.push_back(track_json(track));
  return {
      {"frame", name_of(submap.frame)},
      {"z_is_up", submap.z_is_up},
      {"frame_sets", submap.frame_sets},
      {"ambiguous_frame_sets", told.ambiguous},
      {"observations", told.observations},
      {"rejected", told.rejected},
      {"rms_px", nine_decimals(submap.rms_px)},
      {"rms_all_px", nine_decimals(submap.rms_all_px)},
      {"corner_sigma_px", nine_decimals(told.corner_sigma_px)},
      {"covariances_known", told.covariances_known},
      {"scale_sigma_ppm", told.scale_sigma ? ordered_json(nine_decimals(1e6 * *told.scale_sigma))
                                           : ordered_json(nullptr)},
      {"tracks", std::move(tracks)},
      {"markers", std::move(markers)}};
}

ordered_json radius_json(const std::vector<RadiusBin>& bins) {
  ordered_json json = ordered_json::array();
  for (const RadiusBin& bin : bins) {
    json.push_back({{"from_px", nine_decimals(bin.from_px)},
                    {"to_px", nine_decimals(bin.to_px)},
                    {"corners", bin.corners},
                    {"rms_px", nine_decimals(bin.rms_px)},
                    {"mean_radial_px", nine_decimals(bin.mean_radial_px)},
                    {"mean_tangential_px", nine_decimals(bin.mean_tangential_px)}});
  }
  return json;
}

ordered_json camera_json(const ReportCamera& camera, const CameraResiduals& residuals) {
  return {{"camera", camera.name},
          {"width_px", camera.width_px},
          {"height_px", camera.height_px},
          {"observations", residuals.observations},
          {"rejected", residuals.rejected},
          {"rms_px", nine_decimals(residuals.rms_px)},
          {"mean_px", vector_json(residuals.mean_px)},
          {"by_radius", radius_json(residuals.by_radius)}};
}

ordered_json residuals_json(const Report& report) {
  const ResidualStatistics statistics = residual_statistics(report.observations, report.cameras);
  const ResidualHistogram& histogram = statistics.histogram;
  ordered_json cameras = ordered_json::array();
  for (std::size_t i = 0; i < report.cameras.size(); ++i) {
    cameras.push_back(camera_json(report.cameras[i], statistics.by_camera[i]));
  }
  return {{"corners", statistics.corners},
          {"rms_px", nine_decimals(statistics.rms_px)},
          {"median_px", nine_decimals(statistics.median_px)},
          {"quantile90_px", nine_decimals(statistics.quantile90_px)},
          {"histogram",
           {{"bin_px", nine_decimals(histogram.bin_px)},
            {"accepted", histogram.accepted},
            {"rejected", histogram.rejected},
            {"accepted_beyond", histogram.accepted_beyond},
            {"rejected_beyond", histogram.rejected_beyond}}},
          {"by_radius", radius_json(statistics.by_radius)},
          {"by_camera", std::move(cameras)}};
}

ordered_json survey_json(const ReportSurveyEntry& entry, bool with_family) {
  return {{"entry", entry.entry},
          {"kind", entry.is_point ? "point" : "distance"},
          {"use", entry.check ? "check" : "fit"},
          {"markers", ids_json(entry.markers, with_family)},
          {"measured_m", number_or_null(entry.measured_m)},
          {"mapped_m", number_or_null(entry.mapped_m)},
          {"residual_m", number_or_null(entry.residual_m)},
          {"sigma_m", nine_decimals(entry.sigma_m)}};
}

}  // namespace

std::string json_text(const ordered_json& json, int indent) {
  return json.dump(indent, ' ', false, ordered_json::error_handler_t::replace);
}

ordered_json summary_json(const Report& report) {
  WAYMARK_CHECK(report.submaps.size() == report.map.submaps.size());
  const bool with_family = report.several_families();
  ordered_json captures = ordered_json::array();
  for (const ReportCapture& capture : report.captures) {
    captures.push_back({{"name", capture.name}, {"fingerprint", capture.fingerprint}});
  }
  ordered_json findings = ordered_json::array();
  for (const Finding& finding : report.findings) {
    findings.push_back(finding_json(finding, with_family));
  }
  ordered_json submaps = ordered_json::array();
  for (std::size_t i = 0; i < report.submaps.size(); ++i) {
    submaps.push_back(submap_json(report.map.submaps[i], report.submaps[i], with_family));
  }
  ordered_json survey = ordered_json::array();
  for (const ReportSurveyEntry& entry : report.survey) {
    survey.push_back(survey_json(entry, with_family));
  }
  return {{"schema", kSummarySchema},
          {"map", report.map_name},
          {"content_hash", content_hash(report.map)},
          {"builder_version", report.map.builder_version},
          {"rig_fingerprint", report.map.rig_fingerprint},
          {"captures", std::move(captures)},
          {"findings", std::move(findings)},
          {"unmapped", ids_json(report.unmapped, with_family)},
          {"unlocalized_frame_sets", report.unlocalized},
          {"frame_sets_without_markers", report.without_markers},
          {"submaps", std::move(submaps)},
          {"residuals", residuals_json(report)},
          {"survey", std::move(survey)}};
}

std::string format_summary(const Report& report) {
  return json_text(summary_json(report), 1) + "\n";
}

}  // namespace waymark
