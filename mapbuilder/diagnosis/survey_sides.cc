#include "mapbuilder/diagnosis/survey_sides.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "core/base/median.h"
#include "mapbuilder/diagnosis/length_unit.h"
#include "mapbuilder/diagnosis/scale_votes.h"
#include "mapbuilder/diagnosis/survey_points.h"

namespace waymark {
namespace {

class SurveyJudge {
 public:
  SurveyJudge(const Survey& survey, const BuildResult& result, const Observations& observations,
              const AskBaselines& ask_baselines, double sizes_taken)
      : result_(result),
        observations_(observations),
        ask_baselines_(ask_baselines),
        log_taken_(std::log(sizes_taken)) {
    judged_.survey = survey;
  }

  JudgedSurvey judge() {
    for (const BuiltSubMap& submap : result_.submaps) {
      const auto points = judge_survey_points(submap, result_, observations_, judged_);
      points_ = points.entries;
      witnesses_.clear();
      if (points.scale) witnesses_.push_back(*points.scale);
      hear_distances(submap.map);
      for (ScaleWitness& witness : witnesses_) witness.log_scale += log_taken_;
      judge_scale();
    }
    return std::move(judged_);
  }

 private:
  void hear_distances(const SubMap& map) {
    for (std::size_t i = 0; i < judged_.survey.distances.size(); ++i) {
      const SurveyedDistance& distance = judged_.survey.distances[i];
      const auto from = spot_on(map, distance.from);
      const auto to = spot_on(map, distance.to);
      if (distance.use != SurveyUse::fit || !from || !to) continue;
      const double mapped_m = (to->x_in_world() - from->x_in_world()).norm();
      const double own_m = std::hypot(from->sigma_m, to->sigma_m);
      if (mapped_m < kSameSpotSigmas * own_m) continue;
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
    const double middle = upper_median(logs);
    std::vector<double> off;
    for (const ScaleWitness& one : witnesses_) {
      if (one.side == ScaleSide::distance) {
        off.push_back(std::abs(one.log_scale - middle) / one.sigma);
      }
    }
    const double scatter = std::max(1.0, upper_median(off) / kMedianOfNormal);
    for (ScaleWitness& one : witnesses_) {
      if (one.side == ScaleSide::distance) one.sigma *= scatter;
    }
  }

  void judge_scale() {
    name_units();
    if (witnesses_.empty()) return;
    const ScaleWitness sizes{ScaleSide::sizes, 0, kPrintSigma, 1, 0};
    std::vector<ScaleWitness> all = witnesses_;
    all.push_back(sizes);
    ScaleParty best = heaviest_of(all);
    if (best.members.size() == all.size()) {
      note_scale(best);
      return;
    }
    const double survey_scale = heaviest_of(witnesses_).log_scale;
    if (std::abs(survey_scale) > kSameSpotSigmas * kPrintSigma) {
      const auto answer = ask_baselines_(std::exp(survey_scale));
      if (answer) {
        all.push_back({ScaleSide::baselines, *answer ? survey_scale : 0, kPrintSigma, 1, 0});
      }
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
    Finding& finding = judged_.add(
        Cause::survey_unit, Severity::error, off.size() == 1 ? subject_of(off.front()) : "survey",
        fmt::format("{} {} {:.4g} times too long: in {}? Left out.", names_of(off),
                    off.size() == 1 && off.front().side == ScaleSide::distance ? "is" : "are",
                    std::exp(off.front().log_scale), in_unit(off.front())->name),
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
    if (std::abs(party.log_scale) < kWorthSaying * kPrintSigma) return;
    Finding& finding =
        judged_.add(Cause::size_scale, Severity::warning, "markers.toml",
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
    Finding& finding = judged_.add(
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
        judged_.add(Cause::size_scale, Severity::error, "markers.toml",
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
    Finding& finding = judged_.add(
        points ? Cause::survey_unit : Cause::survey_entry,
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
      for (const std::size_t i : points_) {
        SurveyedPoint& point = judged_.survey.points[i];
        if (point.use == SurveyUse::fit) point.use = SurveyUse::left_out;
      }
    }
  }

  const BuildResult& result_;
  const Observations& observations_;
  const AskBaselines& ask_baselines_;
  const double log_taken_;  ///< of the map's sizes over the stated ones
  JudgedSurvey judged_;
  // Of the sub-map that is being judged.
  std::vector<std::size_t> points_;  ///< of the survey
  std::vector<ScaleWitness> witnesses_;
};

}  // namespace

JudgedSurvey judge_survey(const Survey& survey, const BuildResult& without_it,
                          const Observations& observations, const AskBaselines& ask_baselines,
                          double sizes_taken) {
  return SurveyJudge(survey, without_it, observations, ask_baselines, sizes_taken).judge();
}

}  // namespace waymark
