#include "locd/pose/localizer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/check.h"
#include "core/camera/rig_parameters.h"
#include "core/estimate/calibration_prior.h"
#include "drivers/monotonic_clock.h"
#include "locd/frames/skew_watch.h"
#include "locd/pose/error_model.h"
#include "locd/pose/map_index.h"
#include "locd/pose/map_watch.h"
#include "locd/pose/protection.h"
#include "locd/pose/riding_watch.h"
#include "locd/pose/robust_pose.h"
#include "locd/pose/set_observer.h"
#include "locd/pose/swap_watch.h"

namespace waymark {
namespace {

/// What inliers leave is more than noise and calibration do: something is wrong that no marker
/// alone shows. Noise is known to about a fifth of its variance.
bool contradicts_itself(const PoseSolution& solution) {
  constexpr double kNoiseUnsure = 1.25;
  constexpr double kSigmas = 5.0;
  const double f = solution.freedoms;
  return solution.misfit > kNoiseUnsure * (f + kSigmas * std::sqrt(2 * f));
}

}  // namespace

struct Localizer::Implementation {
  Implementation(const Rig& rig_in, const MarkerMap& map_in, const LocalizerOptions& options_in)
      : rig(rig_in),
        options(options_in),
        map(map_in),
        observer(rig, map, options),
        prior(rig, options.circumstances(), map.submap(), map.calibrated_with(rig)),
        robust(rig, map, prior, {}),
        gate(options.gate),
        motion(options.motion()),
        map_watch(map, robust.solver()),
        error_model(rig, map, map_watch, prior,
                    {.learns_calibration = options_in.online_calibration}),
        protection(rig.cameras.size(), options.protected_point_in_rig,
                   note_of_default_sigmas(rig, "").has_value()),
        swap_watch(rig, map),
        riding_watch(map, robust.solver()),
        skew_watch({options.triggered, options.negligible_skew}) {
    alerts.reserve(kMaxObservations);
    released.reserve(kMostOrders);
    WAYMARK_CHECK(rig.cameras.size() >= 1 && rig.cameras.size() <= kMaxCameras);
    WAYMARK_CHECK(rig.cameras.size() == 1 || rig.has_extrinsics);
    WAYMARK_CHECK(options.check().has_value());
  }

  void localize(const FrameSetLease& set, PoseEstimate& estimate);
  void solve(const FrameSetLease& set, PoseEstimate& estimate);
  void report(const PoseSolution& solution, PoseEstimate& estimate);
  void judge(const FrameSetLease& set, const PoseSolution& solution,
             const std::optional<MotionPrediction>& expected, PoseEstimate& estimate);
  [[nodiscard]] ReasonBits reasons_of_timing(const FrameSetLease& set, bool velocity_known,
                                             const PoseEstimate& estimate) const;
  [[nodiscard]] bool some_camera_disagrees();
  void look_for_riding(Stamp stamp, std::span<const SetObservation> all);
  void release_markers(Stamp stamp);
  void watch(const PoseSolution& solution, PoseEstimate& estimate);

  Rig rig;
  LocalizerOptions options;
  MapIndex map;
  SetObserver observer;
  CalibrationPrior prior;
  RobustPose robust;
  PoseGate gate;
  MotionFilter motion;
  MapWatch map_watch;
  ErrorModel error_model;
  ProtectionLevels protection;
  SwapWatch swap_watch;
  RidingWatch riding_watch;
  SkewWatch skew_watch;
  std::vector<Alert> alerts;
  std::vector<MarkerId> released;  ///< with the next set
};

void Localizer::Implementation::localize(const FrameSetLease& set, PoseEstimate& estimate) {
  alerts.clear();
  estimate.reset(PoseReason::no_markers, set);
  const Stamp started = monotonic_now();
  release_markers(estimate.stamp);
  skew_watch.look(estimate.stamp, estimate.max_skew, alerts);
  observer.look(set, motion.predict(estimate.stamp), estimate, alerts);
  const Stamp detected = monotonic_now();
  observer.leave_out(error_model.suspects(), estimate);
  observer.time_corners(set, estimate);
  if (!observer.used().empty()) solve(set, estimate);
  estimate.times.detect = detected - started;
  estimate.times.solve = monotonic_now() - detected;
}

void Localizer::Implementation::solve(const FrameSetLease& set, PoseEstimate& estimate) {
  const std::span<SetObservation> used = observer.used();
  if (!error_model.begun()) error_model.begin(!used.front().stated[0].isZero());
  const auto expected = motion.predict(estimate.stamp);
  VelocityPrior velocity{Vector6d::Zero(), motion.unknown_velocity_covariance()};
  if (expected) velocity = {expected->velocity, expected->velocity_covariance};
  std::optional<Rigid3> predicted;
  if (expected) predicted = expected->world_from_rig;
  const auto solution = robust.solve(used, predicted, velocity, error_model.known());
  if (!solution) {
    map_watch.look_at_fit(estimate.stamp, 0, static_cast<int>(used.size()), alerts);
    const std::span<const SetObservation> all = observer.all();
    look_for_riding(estimate.stamp, all);
    error_model.learn_noise(estimate.stamp, all, nullptr, robust.solver(), alerts);
    estimate.lose_pose(PoseReason::no_solution);
    return;
  }
  report(*solution, estimate);
  estimate.protection = protection.of(used, *solution, robust);
  map_watch.look_at_fit(estimate.stamp, solution->inlier_markers, solution->outlier_markers,
                        alerts);
  judge(set, *solution, expected, estimate);
  const Stamp judged = monotonic_now();
  robust.hold_against(observer.others(), *solution, error_model.known());
  watch(*solution, estimate);
  estimate.times.watch = monotonic_now() - judged;
}

void Localizer::Implementation::look_for_riding(Stamp stamp, std::span<const SetObservation> all) {
  for (const std::size_t map_index : riding_watch.look(all)) {
    map_watch.quarantine_riding(stamp, map_index, alerts);
    error_model.forget_evidence();
  }
}

void Localizer::Implementation::release_markers(Stamp stamp) {
  for (const MarkerId& marker : released) {
    if (map_watch.release(stamp, marker, alerts)) error_model.forget_evidence();
  }
  released.clear();
}

void Localizer::Implementation::watch(const PoseSolution& solution, PoseEstimate& estimate) {
  for (const SetObservation& o : observer.others()) {
    ObservedMarker& seen = estimate.observations[o.report_index];
    seen.rms_px = o.rms_px;
    seen.sigmas_squared = o.sigmas_squared;
  }
  const std::span<const SetObservation> all = observer.all();
  look_for_riding(estimate.stamp, all);
  error_model.learn_noise(estimate.stamp, all, &solution, robust.solver(), alerts);
  if (estimate.has(PoseReason::no_velocity)) return;
  // A camera that stands elsewhere makes the pose jump between what it and what the others show.
  const CameraMask swapped_before = swap_watch.suspects();
  const auto told = static_cast<std::ptrdiff_t>(alerts.size());
  swap_watch.update(estimate.stamp, solution.world_from_rig, all, alerts);
  const auto of_swaps = static_cast<std::ptrdiff_t>(alerts.size());
  error_model.end_verdicts(estimate.stamp, swap_watch.suspects() & ~swapped_before, alerts);
  // What was said of them is over before the swap is told.
  std::rotate(alerts.begin() + told, alerts.begin() + of_swaps, alerts.end());
  const bool tells = !solution.ambiguous && !estimate.has(PoseReason::jump) &&
                     solution.inlier_markers >= 2 &&
                     solution.inlier_markers >= solution.outlier_markers;
  if (tells) error_model.update(estimate.stamp, all, solution, robust, alerts);
  if (estimate.has(PoseReason::jump)) {
    error_model.interrupt();
    return;
  }
  map_watch.update(estimate.stamp, all, solution, swap_watch.trusted(), alerts);
  map_watch.forget_unknown(estimate.stamp, alerts);
  if (solution.ambiguous || solution.inlier_markers < 2) return;
  for (const ObservedMarker& seen : estimate.observations) {
    if (seen.verdict == ObservationVerdict::unknown) {
      map_watch.note_unknown(estimate.stamp, seen.marker, alerts);
    }
  }
}

void Localizer::Implementation::report(const PoseSolution& solution, PoseEstimate& estimate) {
  estimate.reasons = 0;
  estimate.world_from_rig = solution.world_from_rig;
  estimate.covariance = solution.covariance;
  estimate.markers_used = solution.inlier_markers;
  estimate.observations_used = solution.inliers;
  double sum = 0;
  for (const SetObservation& o : observer.used()) {
    ObservedMarker& seen = estimate.observations[o.report_index];
    seen.verdict = o.inlier ? ObservationVerdict::inlier : ObservationVerdict::outlier;
    seen.rms_px = o.rms_px;
    seen.sigmas_squared = o.sigmas_squared;
    if (!o.inlier) {
      ++estimate.outliers;
      continue;
    }
    sum += o.rms_px * o.rms_px;
    estimate.cameras_used |= camera_bit(static_cast<std::size_t>(o.observation.camera));
  }
  estimate.rms_px = std::sqrt(sum / solution.inliers);
}

/// What stamps and read-outs have against the pose.
ReasonBits Localizer::Implementation::reasons_of_timing(const FrameSetLease& set,
                                                        bool velocity_known,
                                                        const PoseEstimate& estimate) const {
  ReasonBits reasons = 0;
  Stamp readout{0};
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    if (!set.has(c)) continue;
    // As long as it may be, where nobody has stated it.
    constexpr double kSigmas = 3;
    const double unsure_us = 1e6 * kSigmas * std::sqrt(prior.variances_of(c)[kReadout]);
    readout = std::max(readout, from_us(rig.cameras[c].readout_us.value_or(0) + unsure_us));
    if (set.frames[c].info().quality == StampQuality::arrival) {
      reasons |= bit(PoseReason::unsynced);
    }
  }
  if (options.triggered && estimate.max_skew > options.negligible_skew) {
    reasons |= bit(PoseReason::skew);
  }
  const bool needs_velocity = estimate.max_skew + readout > options.negligible_skew;
  if (needs_velocity && !velocity_known) reasons |= bit(PoseReason::no_velocity);
  return reasons;
}

void Localizer::Implementation::judge(const FrameSetLease& set, const PoseSolution& solution,
                                      const std::optional<MotionPrediction>& expected,
                                      PoseEstimate& estimate) {
  if (!expected) gate.forget();
  ReasonBits reasons = gate.judge(estimate.stamp, solution, expected);
  const bool trusted = reasons == 0 || reasons == bit(PoseReason::sigma);
  // In a ring of cameras one swap looks like another one, seen from a rig that is turned: what the
  // others see is no better then.
  if ((error_model.suspects() & estimate.cameras_used) != 0 || swap_watch.suspects() != 0 ||
      some_camera_disagrees()) {
    reasons |= bit(PoseReason::camera_suspect);
  }
  if (error_model.undecided() || contradicts_itself(solution)) reasons |= bit(PoseReason::misfit);
  if (observer.usable() != set.expected) reasons |= bit(PoseReason::camera_missing);
  reasons |= gate.judge(estimate.protection);
  if (map_watch.wrong_map()) reasons |= bit(PoseReason::wrong_map);
  reasons |= reasons_of_timing(set, expected && expected->velocity_known, estimate);
  estimate.resets = gate.resets();
  estimate.reasons = reasons;
  const bool ambiguous = solution.ambiguous || solution.rivals;
  estimate.status = reasons == 0 ? PoseStatus::ok
                    : ambiguous  ? PoseStatus::ambiguous
                                 : PoseStatus::degraded;
  if (trusted) motion.update(estimate.stamp, solution.motion);
  const auto now = motion.predict(estimate.stamp);
  if (now && now->velocity_known) estimate.velocity = now->velocity;
}

/// Whether a camera's markers are mostly outliers: the pose is by others then, and who is right is
/// not known.
bool Localizer::Implementation::some_camera_disagrees() {
  std::array<int, kMaxCameras> markers{};
  std::array<int, kMaxCameras> inliers{};
  for (const SetObservation& o : observer.used()) {
    const auto camera = static_cast<std::size_t>(o.observation.camera);
    ++markers[camera];
    inliers[camera] += o.inlier ? 1 : 0;
  }
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    if (markers[c] >= 2 && 2 * inliers[c] < markers[c]) return true;
  }
  return false;
}

Localizer::Localizer(const Rig& rig, const MarkerMap& map, const LocalizerOptions& options)
    : implementation_(std::make_unique<Implementation>(rig, map, options)) {}
Localizer::~Localizer() = default;

void Localizer::localize(const FrameSetLease& set, PoseEstimate& estimate) {
  implementation_->localize(set, estimate);
}

std::span<const Alert> Localizer::alerts() const { return implementation_->alerts; }

bool Localizer::quarantine_changed() const { return implementation_->map_watch.changed(); }

void Localizer::list_quarantine(std::vector<QuarantinedMarker>& list) {
  implementation_->map_watch.list_quarantine(list);
}

std::size_t Localizer::most_quarantined() const {
  return implementation_->map_watch.most_quarantined();
}

void Localizer::restore_quarantine(std::span<const QuarantinedMarker> markers) {
  implementation_->map_watch.restore(markers);
}

void Localizer::ignore(std::span<const MarkerId> markers) {
  implementation_->observer.ignore(markers.first(std::min(markers.size(), kMostOrders)));
}

void Localizer::release(const MarkerId& marker) {
  std::vector<MarkerId>& released = implementation_->released;
  if (released.size() < kMostOrders) released.push_back(marker);
}

CameraMask Localizer::left_out(DropReason why) const {
  switch (why) {
    case DropReason::unhealthy:
      return implementation_->observer.unhealthy_frames();
    case DropReason::unsearched:
      return implementation_->observer.unsearched();
    default:
      return 0;
  }
}

CameraMask Localizer::unhealthy_cameras() const {
  return implementation_->observer.unhealthy_cameras();
}

void Localizer::remember_images_of(const Localizer& before) {
  implementation_->observer.remember_images_of(before.implementation_->observer);
}

void Localizer::forget_motion() {
  implementation_->motion.reset();
  implementation_->gate.forget();
}

}  // namespace waymark
