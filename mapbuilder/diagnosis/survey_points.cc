#include "mapbuilder/diagnosis/survey_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/alignment.h"
#include "core/marker/marker_geometry.h"
#include "mapbuilder/build/up_direction.h"
#include "mapbuilder/build/world_frame.h"
#include "mapbuilder/diagnosis/place_agreement.h"

namespace waymark {
namespace {

/// Points that scatter by more than so many of their sigmas fix nothing.
constexpr double kMostNoise = 5.0;

/// The images' own doubt of a marker's place (m, per axis); where it is unknown, a centimetre.
double sigma_of(const MapMarker& marker) {
  constexpr double kUnknown_m = 0.01;
  if (!marker.covariance_known()) return kUnknown_m;
  return std::sqrt(marker.covariance.diagonal().head<3>().maxCoeff());
}

/// Points of the survey on markers of one sub-map.
struct PointsOfMap {
  std::vector<std::size_t> index;  ///< in the survey
  std::vector<MeasuredPlace> places;
};

PointsOfMap points_on(const SubMap& map, const Survey& survey) {
  PointsOfMap points;
  for (std::size_t i = 0; i < survey.points.size(); ++i) {
    const SurveyedPoint& point = survey.points[i];
    const auto spot = spot_on(map, point.place);
    if (point.use != SurveyUse::fit || !spot) continue;
    points.index.push_back(i);
    points.places.push_back({spot->marker->world_from_marker, spot->marker->size_m,
                             spot->x_in_marker, point.position_m, point.sigma_m, spot->sigma_m});
  }
  return points;
}

bool on_a_line(const std::vector<MeasuredPlace>& places) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(places.size());
  for (const MeasuredPlace& place : places) {
    points.push_back(place.world_from_marker * place.x_in_marker);
  }
  return lie_on_a_line(points);
}

/// Whether the measured points lie in one level plane: a floor plan with one height.
bool is_flat(const PointsOfMap& points) {
  double lowest = points.places.front().measured.z();
  double highest = lowest;
  double sigma = 0;
  for (const MeasuredPlace& place : points.places) {
    lowest = std::min(lowest, place.measured.z());
    highest = std::max(highest, place.measured.z());
    sigma = std::max(sigma, place.sigma);
  }
  return highest - lowest <= kSameSpotSigmas * sigma;
}

class PointsJudge {
 public:
  PointsJudge(const BuildResult& result, const Observations& observations, JudgedSurvey& judged)
      : result_(result), observations_(observations), judged_(judged) {}

  std::optional<ScaleWitness> judge(const BuiltSubMap& submap, const PointsOfMap& points) {
    if (points.places.size() < 3 || on_a_line(points.places)) return std::nullopt;
    const auto agreement = agreement_of(points.places, kPrintSigma);
    const bool undecided =
        agreement && points.places.size() == 3 && agreement->noise_scale > kMostNoise;
    if (!agreement || undecided) {
      leave_out(points);
      judged_.add(
          Cause::survey_entry, Severity::error, "survey points",
          fmt::format("the {} points do not fit the markers, and not enough of them agree to tell "
                      "which are wrong. None is used.",
                      points.places.size()),
          "Measure them again, and some more.");
      return std::nullopt;
    }
    judge_orientation(submap, points, *agreement);
    if (agreement->fault == CommonFault::shifted) put_at_corner(points, *agreement);
    name_entries(points, *agreement);
    constexpr std::size_t kManyPoints = 4;  // of three no one can be seen to be wrong
    return ScaleWitness{ScaleSide::points, std::log(agreement->scale),
                        agreement->noise_scale * agreement->scale_sigma,
                        agreement->agreeing() >= kManyPoints ? 2.0 : 1.0, 0};
  }

 private:
  void judge_orientation(const BuiltSubMap& submap, const PointsOfMap& points,
                         const PlaceAgreement& agreement) {
    const Eigen::Vector3d camera_up =
        camera_up_in_world(submap, observations_, result_.estimate.calibration);
    const auto by_walls = up_by_walls(submap.map, camera_up);
    constexpr double kUpright = 0.7;
    const bool upright = by_walls.has_value() || camera_up.norm() > kUpright;
    const Eigen::Vector3d up =
        agreement.turned(by_walls ? *by_walls : Eigen::Vector3d(camera_up.normalized()));
    if (agreement.mirrors()) {
      mirrored(points,
               !upright || up.z() > kUpright
                   ? "with y the other way they do"
                   : fmt::format("with one axis the other way they do; up is {}", axis_of(up)));
    } else if (upright && up.z() < -kUpright && is_flat(points)) {
      mirrored(points,
               "laid into them the cameras would hang upside down; with y the other way they do "
               "not");
    } else if (by_walls && up.z() < kUpright) {
      judged_.z_is_up = false;
      judged_.add(Cause::not_level, Severity::warning, "survey points",
                  fmt::format("their z is not up: by walls and cameras up is {}.", axis_of(up)),
                  "Give x, y, z with z up, or reckon with it.");
    }
  }

  static std::string axis_of(const Eigen::Vector3d& direction) {
    Eigen::Index axis = 0;
    direction.cwiseAbs().maxCoeff(&axis);
    return fmt::format("{}{}", direction[axis] < 0 ? "-" : "+", "xyz"[axis]);
  }

  void mirrored(const PointsOfMap& points, const std::string& how) {
    leave_out(points);
    judged_.add(
        Cause::survey_mirrored, Severity::error, "survey points",
        fmt::format("they are left-handed, as on a plan whose y points down: as measured they do "
                    "not fit the markers, {}. None is used.",
                    how),
        "Turn that axis round: count y the other way, or exchange two axes.");
  }

  void put_at_corner(const PointsOfMap& points, const PlaceAgreement& agreement) {
    constexpr std::array<const char*, 4> kNames = {"top-left", "top-right", "bottom-right",
                                                   "bottom-left"};
    std::optional<int> corner;
    const MeasuredPlace& first = points.places.front();
    const Eigen::Vector3d at = first.x_in_marker + first.size_m * agreement.shift;
    double nearest = at.norm();
    for (int c = 0; c < 4; ++c) {
      const double off = (marker_corners(first.size_m)[static_cast<std::size_t>(c)] - at).norm();
      if (off < nearest) {
        nearest = off;
        corner = c;
      }
    }
    for (const std::size_t i : points.index) judged_.survey.points[i].place.corner = corner;
    judged_.add(
        Cause::survey_corner, Severity::error, "survey points",
        fmt::format("they lie ({:+.2f}, {:+.2f}) of a marker's size from the stated spot in every "
                    "marker's plane: measured at the {}?",
                    agreement.shift.x(), agreement.shift.y(),
                    corner ? kNames[static_cast<std::size_t>(*corner)] : "center"),
        "State the corner that was measured.");
  }

  void name_entries(const PointsOfMap& points, const PlaceAgreement& agreement) {
    double worst = 0;
    for (std::size_t i = 0; i < points.places.size(); ++i) {
      if (agreement.agrees[i] != 0) worst = std::max(worst, agreement.off[i]);
    }
    const std::string others = fmt::format("the other {} agree within {:.1f} mm",
                                           agreement.agreeing(), 1e3 * worst / agreement.scale);
    std::vector<char> told = agreement.agrees;
    for (const auto& [a, b] : agreement.exchanged) {
      if (told[a] != 0 || told[b] != 0) continue;
      told[a] = told[b] = 1;
      for (const std::size_t i : {a, b}) entry(points, i).use = SurveyUse::left_out;
      Finding& finding = judged_.add(
          Cause::survey_entry, Severity::warning,
          fmt::format("survey {} and {}", name(points, a), name(points, b)),
          fmt::format("exchanged: each stands where the other was measured; {}. Left out.", others),
          "Exchange the two ids in survey.toml.");
      finding.markers = {entry(points, a).place.marker, entry(points, b).place.marker};
      std::sort(finding.markers.begin(), finding.markers.end());
    }
    for (std::size_t i = 0; i < told.size(); ++i) {
      if (told[i] != 0) continue;
      entry(points, i).use = SurveyUse::left_out;
      const double off_m = agreement.off[i] / agreement.scale;
      Finding& finding = judged_.add(
          Cause::survey_entry, Severity::warning, fmt::format("survey {}", name(points, i)),
          fmt::format("off by {:.0f} mm; {}. Left out.", 1e3 * off_m, others),
          "Measure it again: a typing error, or another marker?");
      finding.markers = {entry(points, i).place.marker};
      finding.figures = {{"off", off_m, "m", points.places[i].sigma}};
    }
  }

  SurveyedPoint& entry(const PointsOfMap& points, std::size_t i) {
    return judged_.survey.points[points.index[i]];
  }

  std::string name(const PointsOfMap& points, std::size_t i) {
    return format_place(entry(points, i).place, observations_.several_families());
  }

  void leave_out(const PointsOfMap& points) {
    for (const std::size_t i : points.index) judged_.survey.points[i].use = SurveyUse::left_out;
  }

  const BuildResult& result_;
  const Observations& observations_;
  JudgedSurvey& judged_;
};

}  // namespace

std::optional<MappedSpot> spot_on(const SubMap& map, const MarkerPlace& place) {
  const auto marker =
      std::find_if(map.markers.begin(), map.markers.end(),
                   [&](const MapMarker& candidate) { return candidate.id == place.marker; });
  if (marker == map.markers.end()) return std::nullopt;
  MappedSpot spot{&*marker, Eigen::Vector3d::Zero(), sigma_of(*marker)};
  if (place.corner) {
    spot.x_in_marker = marker_corners(marker->size_m)[static_cast<std::size_t>(*place.corner)];
  }
  return spot;
}

SurveyPointsOfMap judge_survey_points(const BuiltSubMap& submap, const BuildResult& result,
                                      const Observations& observations, JudgedSurvey& judged) {
  const PointsOfMap points = points_on(submap.map, judged.survey);
  return {points.index, PointsJudge(result, observations, judged).judge(submap, points)};
}

}  // namespace waymark
