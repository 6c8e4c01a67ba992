#include "mapbuilder/diagnosis/rig_time_hypotheses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/decompositions.h"
#include "mapbuilder/diagnosis/best_change.h"
#include "mapbuilder/diagnosis/least_cost.h"
#include "mapbuilder/diagnosis/rig_path.h"

namespace waymark {
namespace {

double milliseconds(double seconds) { return seconds * 1e3; }

/// A camera's place, seen from a path that wanders between frame sets: (C + k B)⁻¹ for any k, with
/// the place's covariance C and what the path wanders per s³, B; by the eigenvectors that both
/// share.
class WanderingPlace {
 public:
  /// `noise_scale` multiplies the place's standard deviations.
  WanderingPlace(const TrackedPlace& place, const RigPath::Wander& wander, double noise_scale) {
    // Of a path that does not wander, a micrometre and microradian per second^1.5.
    constexpr double kLeast = 1e-12;
    Vector6d root;
    root << Eigen::Vector3d::Constant(std::sqrt(std::max(kLeast, wander.position_m2_per_s3))),
        Eigen::Vector3d::Constant(std::sqrt(std::max(kLeast, wander.rotation_rad2_per_s3)));
    const Matrix6d information =
        root.asDiagonal() * place.information * root.asDiagonal() / (noise_scale * noise_scale);
    const SymmetricEigen<6> eigen = symmetric_eigen<6>(information);
    variance_ = eigen.values.cwiseMax(kLeast).cwiseInverse();
    whitened_ = eigen.vectors.transpose() * root.cwiseInverse().asDiagonal();
  }

  /// Squared misfit (sigmas²) after `s3` of wander.
  [[nodiscard]] double squared(const Vector6d& misfit, double s3) const {
    return (whitened_ * misfit).cwiseAbs2().cwiseQuotient(variance(s3)).sum();
  }
  /// ln of the covariance's determinant over that without wander.
  [[nodiscard]] double price(double s3) const {
    return variance(s3).cwiseQuotient(variance_).array().log().sum();
  }
  [[nodiscard]] Matrix6d information(double s3) const {
    return whitened_.transpose() * variance(s3).cwiseInverse().asDiagonal() * whitened_;
  }

 private:
  [[nodiscard]] Vector6d variance(double s3) const { return variance_ + Vector6d::Constant(s3); }

  Vector6d variance_;
  Matrix6d whitened_;
};

/// One camera against the path of the others.
class LateCamera {
 public:
  LateCamera(const RigCase& rig, std::size_t camera)
      : rig_(rig),
        camera_(camera),
        path_(rig.tracks(), rig.stated(), rig.fit().noise_scale(), static_cast<int>(camera)) {}

  [[nodiscard]] const RigPath& path() const { return path_; }

  /// When what it saw was seen, after the stamps.
  [[nodiscard]] LeastCost fit() const {
    // Twice the noise that is left: places that are far off shall draw, too.
    const std::vector<Seen> seen = all_seen(2.0 * rig_.fit().noise_scale());
    const auto cost = [&](double offset_s) {
      double sum = 0;
      for (const Seen& one : seen) {
        const auto motion = path_.motion(one.instant, offset_s);
        const Rigid3 there = motion ? *motion * *path_.at(one.instant) : *path_.at(one.instant);
        const double s3 = path_.wander_s3(one.instant, offset_s);
        const Vector6d misfit = one.place->world_from_cam.minus(there * rig_.stated()[camera_]);
        sum += bounded_misfit(one.wandering.squared(misfit, s3)) + one.wandering.price(s3);
      }
      return sum;
    };
    const double most_s = std::max(0.5, 3.0 * path_.period_s());
    const double step_s = std::min(0.01, path_.period_s() / 8.0);
    return least_cost(-most_s, most_s, step_s, cost, cost);
  }

  /// The tracks with its places moved to the frame sets' stamps, less sure by the path's wander;
  /// with the price of that.
  [[nodiscard]] std::pair<CameraTracks, double> moved_by(double offset_s) const {
    const double noise = rig_.fit().noise_scale();
    std::pair<CameraTracks, double> moved{rig_.tracks(), 0.0};
    for (const Seen& one : all_seen(noise)) {
      const auto motion = path_.motion(one.instant, offset_s);
      if (!motion) continue;
      const double s3 = path_.wander_s3(one.instant, offset_s);
      TrackedPlace& place = *moved.first.instants[one.instant].places[camera_];
      place.world_from_cam = motion->inverse() * place.world_from_cam;
      place.information = noise * noise * one.wandering.information(s3);
      moved.second += one.wandering.price(s3);
    }
    return moved;
  }

 private:
  struct Seen {
    std::size_t instant;
    const TrackedPlace* place;
    WanderingPlace wandering;
  };

  [[nodiscard]] std::vector<Seen> all_seen(double noise_scale) const {
    std::vector<Seen> all;
    for (const std::size_t i : rig_.fit().judged()) {
      const auto& place = rig_.tracks().instants[i].places[camera_];
      if (!place || !path_.at(i)) continue;
      all.push_back({i, &*place, WanderingPlace(*place, path_.wander(), noise_scale)});
    }
    return all;
  }

  const RigCase& rig_;
  std::size_t camera_;
  RigPath path_;
};

/// A camera's places those of so many instants before.
CameraTracks shifted(const CameraTracks& tracks, std::size_t camera, int by) {
  CameraTracks in_step = tracks;
  const auto count = static_cast<std::ptrdiff_t>(tracks.instants.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::ptrdiff_t source = i - by;
    auto& place = in_step.instants[static_cast<std::size_t>(i)].places[camera];
    place.reset();
    if (source >= 0 && source < count) {
      place = tracks.instants[static_cast<std::size_t>(source)].places[camera];
    }
  }
  return in_step;
}

std::optional<RigHypothesis> out_of_step(const RigCase& rig, std::size_t camera, int shift,
                                         const std::vector<double>& as_paired) {
  constexpr std::size_t kFewest = 3;  // instants on each side of the change
  CameraTracks in_step = shifted(rig.tracks(), camera, shift);
  const Change change = best_change(as_paired, rig.fit().costs(in_step, rig.stated()));
  if (!change.splits(rig.fit().judged().size(), kFewest)) return std::nullopt;
  RigHypothesis h = rig.hypothesis();
  h.since = rig.fit().judged()[change.at];
  h.numbers = 2;
  for (std::size_t i = 0; i < h.since; ++i) {
    in_step.instants[i].places[camera] = rig.tracks().instants[i].places[camera];
  }
  h.tracks = std::make_shared<const CameraTracks>(std::move(in_step));
  rig.evaluate(h, rig.stated());
  RigExplanation& e = h.explanation;
  e.cause = Cause::frame_order;
  e.cameras = {camera};
  e.value = shift;
  e.unit = "frames";
  e.since = rig.tracks().instants[h.since].stamp;
  e.detail = fmt::format(
      "from frame set {} on its images show what the others saw {} frame{} {}: a lost frame?",
      e.since->count(), std::abs(shift), std::abs(shift) == 1 ? "" : "s",
      shift > 0 ? "later" : "earlier");
  e.remedy =
      "Pair images by their stamps, not by number; or leave that camera's images out from there "
      "on.";
  e.rig_from_cam = rig.stated();
  e.leave_out = true;
  return h;
}

}  // namespace

std::optional<RigHypothesis> late_hypothesis(const RigCase& rig, std::size_t camera) {
  const LateCamera late(rig, camera);
  if (!late.path().moves()) return std::nullopt;
  const LeastCost fitted = late.fit();
  auto [tracks, price] = late.moved_by(fitted.at);
  RigHypothesis h = rig.hypothesis();
  h.tracks = std::make_shared<const CameraTracks>(std::move(tracks));
  h.price = price;
  h.numbers = 1;
  rig.evaluate(h, rig.stated());
  RigExplanation& e = h.explanation;
  e.cause = Cause::clock;
  e.cameras = {camera};
  e.value = -milliseconds(fitted.at);
  e.sigma = milliseconds(fitted.sigma);
  e.unit = "ms";
  e.detail = fmt::format("its images are {:.1f} ± {:.1f} ms {} than their stamps say, against {}",
                         std::abs(e.value), std::max(0.1, e.sigma), e.value > 0 ? "older" : "newer",
                         rig.names_but(camera));
  e.remedy =
      "Trigger the cameras together, stamp them by one clock, or state the delay where stamps are "
      "made.";
  e.rig_from_cam = rig.stated();
  e.leave_out = true;
  return h;
}

std::vector<RigHypothesis> out_of_step_hypotheses(const RigCase& rig, std::size_t camera) {
  const std::vector<double> as_paired = rig.fit().costs(rig.tracks(), rig.stated());
  std::vector<RigHypothesis> all;
  for (const int shift : {-3, -2, -1, 1, 2, 3}) {
    if (auto h = out_of_step(rig, camera, shift, as_paired)) all.push_back(*std::move(h));
  }
  return all;
}

}  // namespace waymark
