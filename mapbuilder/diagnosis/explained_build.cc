#include "mapbuilder/diagnosis/explained_build.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mapbuilder/diagnosis/capture_causes.h"
#include "mapbuilder/diagnosis/fit_quality.h"
#include "mapbuilder/diagnosis/map_causes.h"
#include "mapbuilder/diagnosis/survey_sides.h"

namespace waymark {
namespace {

/// Whether something that all observations, or all of a camera, share is wrong.
bool is_contradicted(const BuildResult& plain, const FitQuality& quality) {
  const CalibrationResult& calibration = plain.calibration;
  return calibration.extrinsics_cost_ratio < kExplainsTooLittle ||
         calibration.intrinsics_cost_ratio < kExplainsTooLittle || quality.contradicts() ||
         quality.worst_camera_px > kPoorFit_px;
}

void multiply_sizes(DetectedCapture& capture, double by) {
  auto entries = capture.catalog.entries();
  for (auto& entry : entries) {
    if (entry.default_size_m) *entry.default_size_m *= by;
    for (auto& [id, size_m] : entry.size_m_by_id) size_m *= by;
  }
  capture.catalog = MarkerCatalog(std::move(entries));
}

void multiply_baselines(DetectedCapture& capture, double by) {
  for (RigCamera& camera : capture.rig.cameras) camera.rig_from_cam.translation *= by;
}

bool has_baselines(const DetectedCapture& capture) {
  return capture.rig.cameras.size() > 1 && capture.rig.has_extrinsics;
}

/// Of each capture given, the share of its usable observations that the map accepts.
std::vector<double> held_shares(const Observations& observations, const BuildResult& result) {
  std::vector<double> held(observations.captures.size(), 0);
  std::vector<double> all(observations.captures.size(), 0);
  const auto place_of = [&](ObservationIndex index) {
    const CaptureIndex c = observations.frame_sets[observations[index].frame_set].capture;
    return observations.captures[c].place;
  };
  for (std::size_t i = 0; i < observations.usable; ++i) ++all[place_of(ObservationIndex(i))];
  for (const BuiltSubMap& submap : result.submaps) {
    for (const ObservationResidual& residual : submap.residuals) {
      if (residual.accepted) ++held[place_of(residual.observation)];
    }
  }
  for (std::size_t c = 0; c < held.size(); ++c) held[c] /= std::max(1.0, all[c]);
  return held;
}

Finding other_place(const std::string& kept, const std::string& other) {
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::other_place;
  finding.subject = fmt::format("{} and {}", kept, other);
  finding.text = fmt::format(
      "they show the same ids in different places: two buildings? {} is left out.", other);
  finding.remedy = "Build a map of each; give the buildings ids of their own.";
  finding.captures = {kept, other};
  return finding;
}

/// A rig whose map misses by that is looked into before it is built to the end: cameras' places a
/// few centimetres or degrees off make less, inverted and exchanged ones ten and more.
constexpr double kHopeless_px = kLargestModelSigmaOfOneCamera;

Finding unexplained_misfit(const FitQuality& quality) {
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::map_misfit;
  finding.subject = "map";
  finding.text = fmt::format(
      "the images of the worst camera miss it by {} where each marker alone fits to {:.2f} px, and "
      "no single cause explains that: no marker is judged.",
      worst_camera_text(quality), quality.own_px);
  finding.remedy =
      "Check rig.yaml, the stamps, and sizes and ids in markers.toml; build each camera alone with "
      "--mono.";
  if (std::isfinite(quality.worst_camera_px)) {
    finding.figures = {{"worst camera", quality.worst_camera_px, "px", {}}};
  }
  return finding;
}

class ExplainedBuilder {
 public:
  ExplainedBuilder(const std::vector<DetectedCapture>& captures, Observations observations,
                   const ObservationOptions& observing, const BuildOptions& options,
                   Progress& progress)
      : stated_(captures),
        observing_(observing),
        options_(options),
        as_stated_(options),
        progress_(progress),
        captures_(captures) {
    // Judged as stated: a refinement would bend rig and lens to whatever else is wrong, a survey
    // sizes and map.
    as_stated_.refine = {};
    as_stated_.survey = {};
    build_.observations = std::move(observations);
    build_.survey = options.survey;
  }

  Expected<ExplainedBuild> build() {
    if (auto explained = explain(); !explained) return tl::make_unexpected(explained.error());
    if (!options_.survey.empty()) {
      if (auto held = hold_survey_against_it(); !held) return tl::make_unexpected(held.error());
    }
    if (!plain_) build_plainly();
    bool unexplained = is_unexplained();
    if (unexplained && !displaced_.empty()) {
      if (auto taken = put_displaced_right(); !taken) return tl::make_unexpected(taken.error());
      unexplained = is_unexplained();
    }
    BuildOptions options = options_;
    options.survey = build_.survey;
    const bool takes_more = options.refine.any() || !options.survey.empty();
    build_.diagnosed = build_and_diagnose(build_.observations, options, {}, progress_,
                                          takes_more ? std::nullopt : std::move(plain_));
    if (!z_is_up_) say_that_z_is_not_up();
    if (unexplained) name_no_marker();
    return std::move(build_);
  }

 private:
  /// Given up where it misses by a model sigma (px) beyond `give_up_px`.
  void build_plainly(double give_up_px = kLargestModelSigma) {
    const Selection selection(build_.observations);
    BuildOptions options = as_stated_;
    options.growth.give_up_sigma_px = give_up_px;
    plain_ = build_map(selection, options, progress_);
    if (plain_->given_up) {
      quality_ = {0, give_up_px, give_up_px};
      return;
    }
    quality_ = fit_quality(selection, plain_->estimate);
    if (!stated_px_ && build_.causes.empty()) stated_px_ = quality_.joint_px;
  }

  /// Makes what the captures put right show.
  Status take(std::vector<DetectedCapture> captures) {
    auto observations = make_observations(captures, observing_);
    if (!observations) return tl::make_unexpected(observations.error());
    captures_ = std::move(captures);
    build_.observations = *std::move(observations);
    plain_.reset();
    return {};
  }

  /// The map of one capture's own images.
  Expected<SubMap> map_alone(const DetectedCapture& capture) {
    const auto alone = make_observations({capture}, observing_);
    if (!alone) return tl::make_unexpected(alone.error());
    const BuildResult result = build_map(Selection(*alone), as_stated_, progress_);
    return result.submaps.empty() ? SubMap{} : result.submaps.front().map;
  }

  /// Leaves out captures that the map of all does not hold, where their markers stand otherwise to
  /// each other than those of the capture that it holds best.
  Status part_places() {
    // A sound capture is held nearly whole. Of two places the map of both holds half of each, or
    // most where growth went by turns: below this their own maps are compared, which tells.
    constexpr double kHolds = 0.9;
    const std::vector<double> held = held_shares(build_.observations, *plain_);
    const auto best =
        static_cast<std::size_t>(std::max_element(held.begin(), held.end()) - held.begin());
    if (*std::min_element(held.begin(), held.end()) >= kHolds) return {};
    const auto reference = map_alone(captures_[best]);
    if (!reference) return tl::make_unexpected(reference.error());
    std::vector<DetectedCapture> here;
    for (std::size_t c = 0; c < captures_.size(); ++c) {
      bool elsewhere = false;
      if (c != best && held[c] < kHolds) {
        const auto alone = map_alone(captures_[c]);
        if (!alone) return tl::make_unexpected(alone.error());
        elsewhere = are_of_different_places(*alone, *reference);
      }
      if (elsewhere) {
        build_.causes.push_back(other_place(captures_[best].name, captures_[c].name));
      } else {
        here.push_back(captures_[c]);
      }
    }
    if (here.size() == captures_.size()) return {};
    if (auto taken = take(std::move(here)); !taken) return taken;
    build_plainly();
    return {};
  }

  /// A lens that markers' own outlines contradict is looked at before anything is built by it.
  Status explain() {
    LensesBySquares lenses = judge_lenses(telling_images(captures_));
    if (captures_.size() == 1 && contradict(lenses)) {
      if (auto taken = take_what_explains(lenses, nullptr); !taken) return taken;
      if (!build_.causes.empty()) return {};
    }
    if (captures_.size() > 1) {
      build_plainly();
      if (auto parted = part_places(); !parted) return parted;
      lenses = judge_lenses(telling_images(captures_));
    } else {
      build_plainly(kHopeless_px);
    }
    if (!plain_->given_up && !is_contradicted(*plain_, quality_)) return {};
    const StatedBuild stated{build_.observations, *plain_, quality_.joint_px};
    if (auto taken = take_what_explains(lenses, &stated); !taken) return taken;
    if (plain_ && plain_->given_up) build_plainly();
    return {};
  }

  Status take_what_explains(const LensesBySquares& lenses, const StatedBuild* stated) {
    ExplainedCaptures explained = explain_captures(captures_, lenses, stated, as_stated_);
    displaced_ = std::move(explained.displaced);
    if (explained.findings.empty()) return {};
    for (Finding& finding : explained.findings) build_.causes.push_back(std::move(finding));
    return take(std::move(explained.captures));
  }

  /// A map of lengths that contradict each other lies between them: where the sizes are outvoted it
  /// is built anew by those that the survey states, until these stay the same.
  Status hold_survey_against_it() {
    constexpr int kMostRounds = 3;
    constexpr double kSame = 0.001;
    if (!plain_) build_plainly();
    JudgedSurvey judged = judge_survey_with(1.0);
    double taken = 1.0;
    for (int round = 0; round < kMostRounds && judged.sizes_times; ++round) {
      const double further = *judged.sizes_times / taken;
      if (std::abs(further - 1.0) <= kSame) break;
      if (auto done = outvote_sizes(further); !done) return done;
      taken = *judged.sizes_times;
      build_plainly();
      JudgedSurvey better = judge_survey_with(taken);
      if (!better.sizes_times) break;
      judged = std::move(better);
    }
    build_.survey = std::move(judged.survey);
    z_is_up_ = judged.z_is_up;
    for (Finding& finding : judged.findings) build_.causes.push_back(std::move(finding));
    return {};
  }

  [[nodiscard]] JudgedSurvey judge_survey_with(double sizes_taken) {
    return judge_survey(
        options_.survey, *plain_, build_.observations,
        [&](double factor) { return ask_baselines(factor); }, sizes_taken);
  }

  /// Multiplies the captures' sizes. What explained them by sizes against baselines gives way to
  /// who outvotes the sizes.
  Status outvote_sizes(double factor) {
    const auto is_scale = [](const Finding& finding) { return finding.cause == Cause::size_scale; };
    const bool scaled = std::erase_if(build_.causes, is_scale) > 0;
    std::vector<DetectedCapture> captures = scaled && build_.causes.empty() ? stated_ : captures_;
    for (DetectedCapture& capture : captures) {
      multiply_sizes(capture, factor);
      if (scaled && !build_.causes.empty()) multiply_baselines(capture, factor);
    }
    return take(std::move(captures));
  }

  /// Whether the stated rig fits better with sizes so many times those stated, or worse.
  std::optional<bool> ask_baselines(double factor) {
    if (!stated_px_ || observing_.mono ||
        std::none_of(stated_.begin(), stated_.end(), has_baselines)) {
      return std::nullopt;
    }
    std::vector<DetectedCapture> captures = stated_;
    for (DetectedCapture& capture : captures) multiply_sizes(capture, factor);
    const auto observations = make_observations(captures, observing_);
    if (!observations) return std::nullopt;
    const Selection selection(*observations);
    const double so_px =
        fit_quality(selection, build_map(selection, as_stated_, progress_).estimate).joint_px;
    // Less than a fifth better or worse says nothing.
    constexpr double kSays = 1.2;
    if (so_px * kSays < *stated_px_) return true;
    if (so_px > kSays * *stated_px_) return false;
    return std::nullopt;
  }

  /// Whether a camera as a whole still misses, and cameras that stand elsewhere on the rig would,
  /// too.
  bool is_unexplained() {
    if (!quality_.contradicts()) return false;
    const auto& fitted = plain_->calibration.rigs_fitted;
    if (fitted.empty()) return true;
    Observations elsewhere = build_.observations;
    elsewhere.rigs = fitted;
    const Selection selection(elsewhere);
    return fit_quality(selection, build_map(selection, as_stated_, progress_).estimate)
        .contradicts();
  }

  /// Cameras so far from where they are stated that a build's own calibration does not find them.
  Status put_displaced_right() {
    std::vector<DetectedCapture> captures = captures_;
    for (ExplainedCaptures::Displaced& displaced : displaced_) {
      captures[displaced.capture].rig = std::move(displaced.rig);
      build_.causes.push_back(std::move(displaced.finding));
    }
    if (auto taken = take(std::move(captures)); !taken) return taken;
    build_plainly();
    return {};
  }

  /// Markers are judged by what most observations of a camera agree on; where that is nothing,
  /// those that disagree are no more to blame than the rest.
  void name_no_marker() {
    build_.diagnosed.findings.clear();
    build_.causes.push_back(unexplained_misfit(quality_));
  }

  void say_that_z_is_not_up() {
    BuildResult& result = build_.diagnosed.result;
    for (std::size_t i = 0; i < result.submaps.size(); ++i) {
      if (result.submaps[i].map.frame != FrameKind::facility) continue;
      result.submaps[i].map.z_is_up = result.map.submaps[i].z_is_up = false;
    }
  }

  const std::vector<DetectedCapture>& stated_;
  const ObservationOptions observing_;
  const BuildOptions& options_;
  BuildOptions as_stated_;
  Progress& progress_;
  std::vector<DetectedCapture> captures_;  ///< put right
  ExplainedBuild build_;
  std::optional<BuildResult> plain_;  ///< of captures_, nothing refined, no survey
  FitQuality quality_;                ///< of it
  std::vector<ExplainedCaptures::Displaced> displaced_;  ///< that captures_ do not put right
  std::optional<double> stated_px_;                      ///< joint_px of the captures as stated
  bool z_is_up_ = true;
};

/// Whether a cause has named the camera whose lens or place a warning doubts.
bool is_explained(const Finding& finding, const std::vector<Finding>& causes) {
  if (finding.cause != Cause::rig_displaced && finding.cause != Cause::intrinsics) return false;
  return std::any_of(causes.begin(), causes.end(), [&](const Finding& cause) {
    return std::any_of(finding.cameras.begin(), finding.cameras.end(), [&](const auto& camera) {
      return std::find(cause.cameras.begin(), cause.cameras.end(), camera) != cause.cameras.end();
    });
  });
}

}  // namespace

std::vector<Finding> not_explained(std::vector<Finding> findings,
                                   const std::vector<Finding>& causes) {
  std::erase_if(findings, [&](const Finding& finding) { return is_explained(finding, causes); });
  return findings;
}

Expected<ExplainedBuild> build_explained(const std::vector<DetectedCapture>& captures,
                                         Observations observations,
                                         const ObservationOptions& observing,
                                         const BuildOptions& options, Progress& progress) {
  return ExplainedBuilder(captures, std::move(observations), observing, options, progress).build();
}

}  // namespace waymark
