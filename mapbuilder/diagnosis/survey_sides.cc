#include "mapbuilder/diagnosis/survey_sides.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/geometry/alignment.h"
#include "core/marker/marker_geometry.h"
#include "mapbuilder/build/up_direction.h"
#include "mapbuilder/build/world_frame.h"
#include "mapbuilder/diagnosis/place_agreement.h"
#include "mapbuilder/diagnosis/scale_votes.h"

namespace waymark {
namespace {

/// What sizes are printed to, as the adjustment has it.
const double kSizeSigma = BundleScope{}.size_sigma;
/// Heights of a plan, and markers nearer to each other, are one within so many sigmas.
constexpr double kSigmas = 5.0;
/// Points that scatter by more than so many of their sigmas fix nothing.
constexpr double kMostNoise = 5.0;

const MapMarker* find(const SubMap& map, const MarkerId& id) {
  const auto found = std::find_if(map.markers.begin(), map.markers.end(),
                                  [&](const MapMarker& marker) { return marker.id == id; });
  return found == map.markers.end() ? nullptr : &*found;
}

Eigen::Vector3d x_in_marker(const MarkerPlace& place, double size_m) {
  if (!place.corner) return Eigen::Vector3d::Zero();
  return marker_corners(size_m)[static_cast<std::size_t>(*place.corner)];
}

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
    const MapMarker* marker = find(map, point.place.marker);
    if (point.use != SurveyUse::fit || marker == nullptr) continue;
    points.index.push_back(i);
    points.places.push_back({marker->world_from_marker, marker->size_m,
                             x_in_marker(point.place, marker->size_m), point.position_m,
                             point.sigma_m, sigma_of(*marker)});
  }
  return points;
}

bool on_a_line(const std::vector<MeasuredPlace>& places) {
  std::vector<Eigen::Vector3d> points;
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
  return highest - lowest <= kSigmas * sigma;
}

class SurveyJudge {
 public:
  SurveyJudge(const Survey& survey, const BuildResult& result, const Observations& observations,
              const AskBaselines& ask_baselines)
      : result_(result), observations_(observations), ask_baselines_(ask_baselines) {
    judged_.survey = survey;
  }

  JudgedSurvey judge() {
    for (const BuiltSubMap& submap : result_.submaps) {
      witnesses_.clear();
      judge_points(submap);
      hear_distances(submap.map);
      judge_scale();
    }
    return std::move(judged_);
  }

 private:
  // ---- points ----------------------------------------------------------------------------------

  void judge_points(const BuiltSubMap& submap) {
    const PointsOfMap points = points_on(submap.map, judged_.survey);
    if (points.places.size() < 3 || on_a_line(points.places)) return;
    const auto agreement = agreement_of(points.places, kSizeSigma);
    const bool undecided =
        agreement && points.places.size() == 3 && agreement->noise_scale > kMostNoise;
    if (!agreement || undecided) {
      leave_out(points);
      add(Cause::survey_entry, Severity::error, "survey points",
          fmt::format("the {} points do not fit the markers, and not enough of them agree to tell "
                      "which are wrong. None is used.",
                      points.places.size()),
          "Measure them again, and some more.");
      return;
    }
    judge_orientation(submap, points, *agreement);
    if (agreement->fault == CommonFault::shifted) put_at_corner(points, *agreement);
    name_entries(points, *agreement);
    constexpr std::size_t kManyPoints = 4;  // of three no one can be seen to be wrong
    witnesses_.push_back({ScaleSide::points, std::log(agreement->scale),
                          agreement->noise_scale * agreement->scale_sigma,
                          agreement->agreeing() >= kManyPoints ? 2.0 : 1.0, 0});
  }

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
      add(Cause::not_level, Severity::warning, "survey points",
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
    add(Cause::survey_mirrored, Severity::error, "survey points",
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
    const Eigen::Vector3d at = first.x_in_marker + agreement.shift_m;
    double nearest = at.norm();
    for (int c = 0; c < 4; ++c) {
      const double off = (marker_corners(first.size_m)[static_cast<std::size_t>(c)] - at).norm();
      if (off < nearest) {
        nearest = off;
        corner = c;
      }
    }
    for (const std::size_t i : points.index) judged_.survey.points[i].place.corner = corner;
    add(Cause::survey_corner, Severity::error, "survey points",
        fmt::format("they lie at ({:+.3f}, {:+.3f}) m from the stated spot in every marker's "
                    "plane: measured at the {}?",
                    agreement.shift_m.x(), agreement.shift_m.y(),
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
      Finding& finding = add(
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
      Finding& finding =
          add(Cause::survey_entry, Severity::warning, fmt::format("survey {}", name(points, i)),
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

  // ---- scale -----------------------------------------------------------------------------------

  void hear_distances(const SubMap& map) {
    for (std::size_t i = 0; i < judged_.survey.distances.size(); ++i) {
      const SurveyedDistance& distance = judged_.survey.distances[i];
      const MapMarker* from = find(map, distance.from.marker);
      const MapMarker* to = find(map, distance.to.marker);
      if (distance.use != SurveyUse::fit || from == nullptr || to == nullptr) continue;
      const double mapped_m = (to->world_from_marker * x_in_marker(distance.to, to->size_m) -
                               from->world_from_marker * x_in_marker(distance.from, from->size_m))
                                  .norm();
      const double own_m = std::hypot(sigma_of(*from), sigma_of(*to));
      if (mapped_m < kSigmas * own_m) continue;
      witnesses_.push_back({ScaleSide::distance, std::log(distance.distance_m / mapped_m),
                            std::hypot(distance.sigma_m / distance.distance_m, own_m / mapped_m), 1,
                            i});
    }
    widen_distances();
  }

  /// Where many distances scatter by more than they state, they are worth what they scatter.
  void widen_distances() {
    std::vector<double> logs;
    for (const ScaleWitness& one : witnesses_) {
      if (one.side == ScaleSide::distance) logs.push_back(one.log_scale);
    }
    constexpr std::size_t kFew = 4;
    if (logs.size() < kFew) return;
    const double middle = median(logs);
    std::vector<double> off;
    for (const ScaleWitness& one : witnesses_) {
      if (one.side == ScaleSide::distance) {
        off.push_back(std::abs(one.log_scale - middle) / one.sigma);
      }
    }
    constexpr double kMedianOfNormal = 0.6745;
    const double scatter = std::max(1.0, median(off) / kMedianOfNormal);
    for (ScaleWitness& one : witnesses_) {
      if (one.side == ScaleSide::distance) one.sigma *= scatter;
    }
  }

  static double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  void judge_scale() {
    name_units();
    if (witnesses_.empty()) return;
    const ScaleWitness sizes{ScaleSide::sizes, 0, kSizeSigma, 1, 0};
    std::vector<ScaleWitness> all = witnesses_;
    all.push_back(sizes);
    ScaleParty best = heaviest_of(all);
    if (best.members.size() == all.size()) {
      note_scale(best);
      return;
    }
    const double survey_scale = heaviest_of(witnesses_).log_scale;
    if (std::abs(survey_scale) > kSigmas * kSizeSigma) {
      const auto answer = ask_baselines_(std::exp(survey_scale));
      if (answer)
        all.push_back({ScaleSide::baselines, *answer ? survey_scale : 0, kSizeSigma, 1, 0});
      best = heaviest_of(all);
    }
    std::vector<ScaleWitness> others;
    for (const ScaleWitness& one : all) {
      if (!holds(best, one)) others.push_back(one);
    }
    const ScaleParty against = heaviest_of(others);
    if (against.weight >= best.weight) {
      stand_against_each_other(best, against);
    } else if (!holds(best, sizes)) {
      outvote_sizes(best, against);
    } else {
      outvote_survey(best, others);
    }
  }

  /// Lengths that are as many times too long as a metre has other units come before all votes.
  void name_units() {
    const auto in_unit = [](const ScaleWitness& one) { return unit_of(std::exp(one.log_scale)); };
    std::vector<ScaleWitness> off;
    std::copy_if(witnesses_.begin(), witnesses_.end(), std::back_inserter(off), in_unit);
    if (off.empty()) return;
    for (const ScaleWitness& one : off) leave_out(one);
    std::erase_if(witnesses_, in_unit);
    Finding& finding = add(
        Cause::survey_unit, Severity::error, off.size() == 1 ? subject_of(off.front()) : "survey",
        fmt::format("{} {} {:.4g} times too long: in {}? Left out.", names_of(off),
                    off.size() == 1 && off.front().side == ScaleSide::distance ? "is" : "are",
                    std::exp(off.front().log_scale), *in_unit(off.front())),
        "Write the survey in metres.");
    finding.figures = {{"factor", std::exp(off.front().log_scale), "",
                        off.front().sigma * std::exp(off.front().log_scale)}};
  }

  std::string subject_of(const ScaleWitness& one) const {
    return one.side == ScaleSide::points
               ? "survey points"
               : fmt::format("survey {} – {}", distance_end(one, true), distance_end(one, false));
  }

  /// The survey corrects the stated sizes by more than prints differ.
  void note_scale(const ScaleParty& party) {
    constexpr double kWorthSaying = 3.0;  // sigmas of a print
    if (std::abs(party.log_scale) < kWorthSaying * kSizeSigma) return;
    Finding& finding =
        add(Cause::size_scale, Severity::warning, "markers.toml",
            fmt::format("stated sizes are {}, by {}; the map takes the survey's scale.",
                        percent(-party.log_scale, party.sigma), names_of(witnesses_)),
            "Measure the outer edge of a marker's black border and correct markers.toml.");
    finding.figures = {size_figure(-party.log_scale, party.sigma)};
  }

  /// "20.0 ± 0.1 % too small": of stated sizes over those that fit.
  static std::string percent(double log_stated, double sigma) {
    const double share = 100 * std::expm1(log_stated);
    return fmt::format("{:.1f} ± {:.1f} % too {}", std::abs(share), std::max(0.1, 100 * sigma),
                       share < 0 ? "small" : "large");
  }

  static Figure size_figure(double log_stated, double sigma) {
    return {"sizes", 100 * std::expm1(log_stated), "%", 100 * sigma};
  }

  void stand_against_each_other(const ScaleParty& one, const ScaleParty& other) {
    const bool one_is_survey =
        std::none_of(one.members.begin(), one.members.end(),
                     [](const ScaleWitness& w) { return w.side == ScaleSide::sizes; });
    const ScaleParty& survey = one_is_survey ? one : other;
    const ScaleParty& rest = one_is_survey ? other : one;
    for (const ScaleWitness& w : witnesses_) leave_out(w);
    Finding& finding = add(
        Cause::size_scale, Severity::error, "markers.toml, survey",
        fmt::format("stated sizes are {} by {}, and {} stand against that: nobody tells who is "
                    "right. The survey's lengths are not used.",
                    percent(rest.log_scale - survey.log_scale, survey.sigma),
                    names_of(survey.members), names_of(rest.members)),
        "Measure the outer edge of a marker's black border and correct markers.toml; if it is as "
        "stated, measure the survey's lengths again, in metres.");
    finding.figures = {size_figure(rest.log_scale - survey.log_scale, survey.sigma)};
  }

  void outvote_sizes(const ScaleParty& best, const ScaleParty& against) {
    judged_.sizes_times = std::exp(best.log_scale);
    Finding& finding =
        add(Cause::size_scale, Severity::error, "markers.toml",
            fmt::format("stated sizes are {} by {}.", percent(-best.log_scale, best.sigma),
                        names_of(best.members)),
            "Measure the outer edge of a marker's black border and correct markers.toml.");
    finding.figures = {size_figure(-best.log_scale, best.sigma)};
    for (const ScaleWitness& w : against.members) name_length(w, best);
  }

  void outvote_survey(const ScaleParty& best, const std::vector<ScaleWitness>& others) {
    for (const ScaleWitness& w : others) name_length(w, best);
  }

  /// A length of the survey that stands alone, with its factor.
  void name_length(const ScaleWitness& one, const ScaleParty& best) {
    if (one.side == ScaleSide::sizes || one.side == ScaleSide::baselines) return;
    leave_out(one);
    const double factor = std::exp(one.log_scale - best.log_scale);
    std::string off =
        fmt::format("{:.1f} % too {}", 100 * std::abs(factor - 1), factor < 1 ? "short" : "long");
    const bool points = one.side == ScaleSide::points;
    if (!points) {
      const double stated_m = judged_.survey.distances[one.entry].distance_m;
      off = fmt::format("off by {:.0f} mm ({})", 1e3 * std::abs(stated_m - stated_m / factor), off);
    }
    Finding& finding =
        add(points ? Cause::survey_unit : Cause::survey_entry,
            points ? Severity::error : Severity::warning, subject_of(one),
            fmt::format("{}; {} agree with each other. Left out.", off, names_of(best.members)),
            points ? "Look at the survey's unit and instrument; measure a distance by tape."
                   : "Measure it again.");
    finding.figures = {{"factor", factor, "", one.sigma * factor}};
  }

  std::string distance_end(const ScaleWitness& one, bool first) const {
    const SurveyedDistance& distance = judged_.survey.distances[one.entry];
    return format_place(first ? distance.from : distance.to, observations_.several_families());
  }

  void leave_out(const ScaleWitness& one) {
    if (one.side == ScaleSide::distance) {
      judged_.survey.distances[one.entry].use = SurveyUse::left_out;
    } else if (one.side == ScaleSide::points) {
      for (SurveyedPoint& point : judged_.survey.points) {
        if (point.use == SurveyUse::fit) point.use = SurveyUse::left_out;
      }
    }
  }

  Finding& add(Cause cause, Severity severity, std::string subject, std::string text,
               std::string remedy) {
    Finding finding;
    finding.cause = cause;
    finding.severity = severity;
    finding.subject = std::move(subject);
    finding.text = std::move(text);
    finding.remedy = std::move(remedy);
    judged_.findings.push_back(std::move(finding));
    return judged_.findings.back();
  }

  const BuildResult& result_;
  const Observations& observations_;
  const AskBaselines& ask_baselines_;
  JudgedSurvey judged_;
  std::vector<ScaleWitness> witnesses_;
};

}  // namespace

JudgedSurvey judge_survey(const Survey& survey, const BuildResult& without_it,
                          const Observations& observations, const AskBaselines& ask_baselines) {
  return SurveyJudge(survey, without_it, observations, ask_baselines).judge();
}

}  // namespace waymark
