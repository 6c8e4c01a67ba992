#include "mapbuilder/diagnosis/rig_judge.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "mapbuilder/diagnosis/rig_file_hypotheses.h"
#include "mapbuilder/diagnosis/rig_place_hypotheses.h"
#include "mapbuilder/diagnosis/rig_scale_hypothesis.h"
#include "mapbuilder/diagnosis/rig_time_hypotheses.h"

namespace waymark {
namespace {

/// Fewer instants with two cameras tell nothing apart.
constexpr std::size_t kMinInstants = 3;
/// 2 Δ ln L that a hypothesis must gain on the stated rig, and stand above the next cause.
constexpr double kMinGain = 20.0;
constexpr double kMinLead = 10.0;
/// What the stated rig must cost (× the tracks' freedoms, which is what noise alone costs), and the
/// share of what it costs beyond noise that a cause explains: less is a calibration that could be
/// better.
constexpr double kMinMisfit = 1.5;
constexpr double kMinExplained = 1.0 / 3.0;

/// Of an explanation with more numbers, the share (0.5–0.9) that one with fewer must explain to
/// come first: a delay's remaining misfit is the path's own noise, a bump's can be fitted to it.
constexpr double kSimplerExplains = 0.7;

/// What may be the matter, by who would check it first.
std::vector<RigHypothesis> hypotheses_of(const RigCase& rig) {
  std::vector<RigHypothesis> all = rig_file_hypotheses(rig);
  const auto add = [&](std::optional<RigHypothesis> h) {
    if (h) all.push_back(*std::move(h));
  };
  const auto add_several = [&](std::vector<RigHypothesis> several) {
    std::move(several.begin(), several.end(), std::back_inserter(all));
  };
  const auto add_displaced = [&](const std::optional<RigHypothesis>& h) {
    if (!h) return;
    all.push_back(*h);
    add(exchanged_hypothesis(rig, *h));
  };
  add(rig_scale_hypothesis(rig));
  // Of two, only how they stand to each other is known.
  for (std::size_t k = rig.cameras() == 2 ? 1 : 0; k < rig.cameras(); ++k) {
    add(late_hypothesis(rig, k));
    add_several(out_of_step_hypotheses(rig, k));
    add_several(bumped_hypotheses(rig, k));
    add_displaced(displaced_hypothesis(rig, k));
  }
  if (rig.cameras() > 2) add_displaced(all_displaced_hypothesis(rig));
  return all;
}

/// Numbers that the tracks hold beside the rig's poses.
double freedoms(const RigCase& rig) {
  double places = 0;
  for (const std::size_t i : rig.fit().judged()) {
    const auto& instant = rig.tracks().instants[i].places;
    places += static_cast<double>(std::count_if(instant.begin(), instant.end(),
                                                [](const auto& p) { return p.has_value(); })) -
              1.0;
  }
  return 6.0 * places;
}

/// How far the lenses that the images fit are from those that an explanation gives them (sigmas²):
/// exchanged cameras take theirs along, images turned in the driver turn the principal point.
double lens_misfit(const CameraTracks& tracks, const Rig& stated, const RigExplanation& e) {
  constexpr double kSigma_px = 3.0;  // of a principal point that images of one camera tell
  constexpr double kMost = 50.0;     // a lens that is wrong for a reason of its own
  double sum = 0;
  for (std::size_t k = 0; k < tracks.lenses.size(); ++k) {
    std::size_t actual = k;
    if (e.exchanges_lenses && k == e.cameras[0]) actual = e.cameras[1];
    if (e.exchanges_lenses && k == e.cameras[1]) actual = e.cameras[0];
    const bool turned =
        e.turns_lenses && std::find(e.cameras.begin(), e.cameras.end(), k) != e.cameras.end();
    const CameraParameters& fits = tracks.lenses[k].parameters();
    const CameraParameters& p = stated.cameras[actual].model.parameters();
    const Eigen::Vector2d point =
        turned ? Eigen::Vector2d(p.width_px - 1 - p.pu_px, p.height_px - 1 - p.pv_px)
               : Eigen::Vector2d(p.pu_px, p.pv_px);
    const double off_px = (point - Eigen::Vector2d(fits.pu_px, fits.pv_px)).norm();
    sum += std::min(kMost, off_px * off_px / (kSigma_px * kSigma_px));
  }
  return sum;
}

/// Whether one of fewer numbers explains nearly what the other does.
bool comes_before(const RigHypothesis& simple, const RigHypothesis& other) {
  return simple.numbers < other.numbers &&
         simple.explanation.gain > kSimplerExplains * other.explanation.gain;
}

/// The one of fewest numbers that explains nearly what the best does.
const RigHypothesis& simplest_of(const std::vector<RigHypothesis>& all, const RigHypothesis& best) {
  const RigHypothesis* simplest = &best;
  for (const RigHypothesis& h : all) {
    if (!comes_before(h, best) || h.numbers > simplest->numbers) continue;
    const bool fewer = h.numbers < simplest->numbers;
    if (fewer || h.explanation.gain > simplest->explanation.gain) simplest = &h;
  }
  return *simplest;
}

bool same_culprit(const RigExplanation& a, const RigExplanation& b) {
  return a.cause == b.cause && a.cameras == b.cameras;
}

/// Chooses among hypotheses whose gains are known.
std::optional<RigExplanation> verdict(const std::vector<RigHypothesis>& all, double stated_cost,
                                      double freedoms, double noise_scale) {
  const auto gain = [](const RigHypothesis& h) { return h.explanation.gain; };
  const auto most = std::max_element(
      all.begin(), all.end(),
      [&](const RigHypothesis& a, const RigHypothesis& b) { return gain(a) < gain(b); });
  if (most == all.end() || gain(*most) < kMinGain || stated_cost < kMinMisfit * freedoms ||
      stated_cost - most->cost < kMinExplained * (stated_cost - freedoms)) {
    return std::nullopt;
  }
  // Numbers may be fitted to whatever bends the tracks; they explain only what they leave at about
  // the places' own noise.
  constexpr double kMostNoise = 2.5;
  if (!most->listed && noise_scale > kMostNoise) return std::nullopt;
  // What a file is easily written wrongly like comes before numbers that happen to fit as well, the
  // first of them before others that the rig's symmetry makes equal.
  const double enough = gain(*most) - kMinLead;
  const auto first = std::find_if(
      all.begin(), all.end(), [&](const RigHypothesis& h) { return h.listed && gain(h) > enough; });
  const RigHypothesis& best = first != all.end() ? *first : simplest_of(all, *most);
  const RigHypothesis* rival = nullptr;
  for (const RigHypothesis& h : all) {
    if (same_culprit(h.explanation, best.explanation) || gain(h) < gain(best) - kMinLead) continue;
    if ((best.listed && !h.listed) || comes_before(best, h)) continue;
    if (rival == nullptr || gain(h) > gain(*rival)) rival = &h;
  }
  RigExplanation explanation = best.explanation;
  if (rival == nullptr) return explanation;
  // Two numbers that fit as well as each other name nobody.
  if (!best.listed) return std::nullopt;
  const RigExplanation& other = rival->explanation;
  explanation.alternative = {other.cause, other.cameras, other.detail, other.remedy};
  return explanation;
}

}  // namespace

std::optional<RigExplanation> explain_rig(const CameraTracks& tracks, const Rig& stated) {
  Extrinsics places;
  for (const RigCamera& camera : stated.cameras) places.push_back(camera.rig_from_cam);
  RigFit fit(tracks, places);
  if (fit.judged().size() < kMinInstants || places.size() < 2) return std::nullopt;
  // First with room for noise, then with that which the best explanation leaves.
  fit.set_noise_scale(4.0);
  double scale = std::numeric_limits<double>::infinity();
  {
    const RigCase rig(tracks, stated, fit);
    scale = rig.noise_left(rig.as_stated());
    for (const RigHypothesis& h : hypotheses_of(rig)) scale = std::min(scale, rig.noise_left(h));
  }
  fit.set_noise_scale(std::clamp(scale, 1.0, 50.0));
  const RigCase rig(tracks, stated, fit);
  std::vector<RigHypothesis> all = hypotheses_of(rig);
  const double stated_cost = rig.as_stated().cost;
  const double n = freedoms(rig);
  for (RigHypothesis& h : all) {
    h.explanation.gain = n * std::log(stated_cost / std::max(h.cost, 1e-9)) -
                         h.numbers * std::log(n) - h.price + lens_misfit(tracks, stated, {}) -
                         lens_misfit(tracks, stated, h.explanation);
  }
  return verdict(all, stated_cost, n, fit.noise_scale());
}

}  // namespace waymark
