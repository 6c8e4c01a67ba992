#include "mapbuilder/calibrate/lens_growth.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/camera/lens_kind.h"
#include "mapbuilder/calibrate/lens_starts.h"
#include "mapbuilder/diagnosis/mono_build.h"
#include "mapbuilder/diagnosis/square_equations.h"

namespace waymark {
namespace {

/// A lens with the map that it was refined in.
struct Candidate {
  CameraParameters parameters;
  MonoBuild mono;
  FitQuality fit;
  [[nodiscard]] bool firm() const { return mono.result.calibration.refined; }
};

std::vector<DetectedCapture> with_lens(std::vector<DetectedCapture> alone,
                                       const CameraModel& lens) {
  for (DetectedCapture& capture : alone) capture.rig.cameras.front().model = lens;
  return alone;
}

std::size_t detections_in(const std::vector<DetectedCapture>& captures) {
  std::size_t count = 0;
  for (const DetectedCapture& capture : captures) {
    for (const ImageDetections& image : capture.images) count += image.detections.size();
  }
  return count;
}

/// Whether one is to be preferred to another from a further start.
bool fits_better(const Candidate& one, const Candidate& other) {
  if (one.firm() != other.firm()) return one.firm();
  return one.fit.joint_px < other.fit.joint_px;
}

class LensGrowth {
 public:
  LensGrowth(const std::vector<DetectedCapture>& alone, const BuildOptions& options)
      : alone_(telling_images(alone)), options_(options) {
    for (const DetectedCapture& capture : alone_) {
      const auto more = outlines_of(capture, 0);
      outlines_.insert(outlines_.end(), more.begin(), more.end());
    }
  }

  [[nodiscard]] LensStarts starts_of(Distortion kind) const {
    return lens_starts(alone_.front().rig.cameras.front().model.parameters(), kind, outlines_);
  }

  /// The best lens of one kind.
  [[nodiscard]] std::optional<Candidate> best_of(const LensStarts& starts) const {
    std::optional<Candidate> best;
    for (const CameraParameters& start : starts.lenses) {
      auto found = refined_to_rest(start, MonoLenses::refined);
      if (!found) continue;
      if (!best || fits_better(*found, *best)) best = std::move(found);
      if (best->firm() && !is_poor(best->fit)) break;
    }
    return best;
  }

  /// A straight lens near one that may bend.
  [[nodiscard]] std::optional<Candidate> unbent(CameraParameters near) const {
    near.distortion = Distortion::none;
    near.coefficients = {};
    return refined_to_rest(near, MonoLenses::refined_unbent);
  }

  /// A lens of a kind that has further coefficients, from one that has fewer.
  [[nodiscard]] std::optional<Candidate> grown_to(Distortion kind, CameraParameters from) const {
    from.distortion = kind;
    return refined_to_rest(from, MonoLenses::refined);
  }

  /// Whether a lens is worth more numbers than another.
  [[nodiscard]] bool explains_more(const Candidate& larger, const Candidate& smaller) const {
    if (larger.firm() != smaller.firm()) return larger.firm();
    const double sigma_px = std::max(1e-3, std::min(larger.fit.joint_px, smaller.fit.joint_px));
    return std::isfinite(sigma_px) && criterion(larger, sigma_px) < criterion(smaller, sigma_px);
  }

  /// Bayes' information criterion: what the residuals cost in sigmas², each bounded, and ln n per
  /// number of the lens. `sigma_px` is what corners are worth by the best of the lenses compared.
  [[nodiscard]] double criterion(const Candidate& one, double sigma_px) const {
    // Nearly all of χ² with eight freedoms; what has no pose costs as much.
    constexpr double kMost = 40;
    const Estimate& estimate = one.mono.result.evidence();
    const Observations& observations = one.mono.observations;
    const Selection selection(observations);
    const std::size_t all = detections_in(alone_);
    double cost = kMost * static_cast<double>(all - std::min(all, selection.used().size()));
    for (const ObservationIndex index : selection.used()) {
      const double squared = joint_residual_px2(observations, estimate, observations[index]);
      cost += std::min(kMost, squared / (sigma_px * sigma_px));
    }
    const double numbers = 4 + lens_kind(one.parameters.distortion).count();
    return cost + numbers * std::log(8.0 * static_cast<double>(all));
  }

 private:
  [[nodiscard]] std::optional<Candidate> refined(const CameraParameters& start,
                                                 MonoLenses lenses) const {
    const auto model = CameraModel::create(start);
    if (!model) return std::nullopt;
    auto mono = build_mono(with_lens(alone_, *model), options_, lenses);
    if (!mono) return std::nullopt;
    const Estimate& estimate = mono->result.evidence();
    const FitQuality fit = fit_quality(Selection(mono->observations), estimate);
    const CameraParameters found =
        estimate.calibration.rigs[RigIndex(0)].cameras.front().model.parameters();
    return Candidate{found, *std::move(mono), fit};
  }

  /// A map grown with a lens far from the true one lacks images and markers: again with what it has
  /// come to, until nothing is won.
  [[nodiscard]] std::optional<Candidate> refined_to_rest(const CameraParameters& start,
                                                         MonoLenses lenses) const {
    constexpr int kMostRounds = 4;
    constexpr double kWorthAnother = 0.98;
    auto best = refined(start, lenses);
    for (int round = 1; best && round < kMostRounds; ++round) {
      auto next = refined(best->parameters, lenses);
      if (!next || !fits_better(*next, *best)) break;
      const bool goes_on = !best->firm() || next->fit.joint_px < kWorthAnother * best->fit.joint_px;
      best = std::move(next);
      if (!goes_on) break;
    }
    return best;
  }

  std::vector<DetectedCapture> alone_;
  const BuildOptions& options_;
  std::vector<ImageCorners> outlines_;
};

/// Whether a lens sees so far across the image's longer side that it may be a fisheye's: 80°. Of
/// narrower ones its polynomial has two numbers more than radtan's, which follow whatever else is
/// wrong with an image.
bool is_wide(const CameraParameters& lens) {
  constexpr double kHalf_rad = 0.7;
  const auto model = CameraModel::create(lens);
  if (!model) return false;
  const bool lying = lens.width_px >= lens.height_px;
  for (const double end_px : {-0.5, (lying ? lens.width_px : lens.height_px) - 0.5}) {
    const auto bearing = model->bearing(lying ? Eigen::Vector2d(end_px, lens.pv_px)
                                              : Eigen::Vector2d(lens.pu_px, end_px));
    if (!bearing) return true;  // beyond the polynomial's end
    if (std::acos(bearing->z()) > kHalf_rad) return true;
  }
  return false;
}

/// Lenses that bend by radius, each grown from the one before, which is zero in what it lacks:
/// while the larger one explains more than its numbers cost, or up to the kind that is asked for.
/// radtan has k3 where that explains.
std::vector<Candidate> grown_radially(const LensGrowth& growth, Candidate bent,
                                      std::optional<Distortion> kind) {
  std::vector<Candidate> grown{std::move(bent)};
  for (const Distortion next : {Distortion::radtan5, Distortion::rational}) {
    if (kind == Distortion::radtan && next == Distortion::rational) break;
    auto larger = growth.grown_to(next, grown.back().parameters);
    const bool asked = kind == Distortion::rational;
    if (!larger || (!asked && !growth.explains_more(*larger, grown.back()))) break;
    if (asked) grown.clear();
    grown.push_back(*std::move(larger));
  }
  return grown;
}

/// What may be compared: each kind asked for that markers' outlines do not rule out, a straight
/// lens beside the bent one.
std::vector<Candidate> candidates_of(const LensGrowth& growth, std::optional<Distortion> kind) {
  // As judge_lens has it: by so much only another lens differs.
  constexpr double kRuledOut = 1.4;
  const bool asks_wide = kind && bends_by_angle(*kind);
  const LensStarts radtan = growth.starts_of(Distortion::radtan);
  const LensStarts fisheye = growth.starts_of(asks_wide ? *kind : Distortion::equidistant);
  const bool may_be_radtan = kind ? !asks_wide : !(radtan.own_px > kRuledOut * fisheye.own_px);
  const bool may_be_fisheye =
      kind ? asks_wide
           : !(fisheye.own_px > kRuledOut * radtan.own_px) && is_wide(fisheye.lenses.front());
  std::vector<Candidate> candidates;
  const auto take = [&](std::optional<Candidate> one) {
    if (one) candidates.push_back(*std::move(one));
  };
  if (may_be_radtan) {
    auto bent = growth.best_of(radtan);
    if (bent && (!kind || kind == Distortion::none)) take(growth.unbent(bent->parameters));
    if (bent && kind != Distortion::none) {
      for (Candidate& one : grown_radially(growth, *std::move(bent), kind)) take(std::move(one));
    }
  }
  if (may_be_fisheye) take(growth.best_of(fisheye));
  return candidates;
}

}  // namespace

std::optional<GrownLens> grow_lens(const std::vector<DetectedCapture>& alone,
                                   std::optional<Distortion> kind, const BuildOptions& options) {
  const LensGrowth growth(alone, options);
  const std::vector<Candidate> candidates = candidates_of(growth, kind);
  if (candidates.empty()) return std::nullopt;
  double sigma_px = std::numeric_limits<double>::infinity();
  for (const Candidate& one : candidates) sigma_px = std::min(sigma_px, one.fit.joint_px);
  // Where no map holds half the corners, any yardstick will do.
  if (!std::isfinite(sigma_px)) sigma_px = 1;
  std::vector<double> criteria;
  std::vector<std::string> told;
  for (const Candidate& one : candidates) {
    criteria.push_back(growth.criterion(one, std::max(1e-3, sigma_px)));
    told.push_back(fmt::format("{} {:.0f}", to_string(one.parameters.distortion), criteria.back()));
  }
  const auto best = std::min_element(criteria.begin(), criteria.end()) - criteria.begin();
  const Candidate& chosen = candidates[static_cast<std::size_t>(best)];
  return GrownLens{chosen.parameters, chosen.fit, chosen.firm(),
                   chosen.mono.result.calibration.refused,
                   fmt::format("{}", fmt::join(told, ", "))};
}

}  // namespace waymark
