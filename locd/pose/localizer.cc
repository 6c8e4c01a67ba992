#include "locd/pose/localizer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <tuple>

#include "core/base/check.h"
#include "drivers/monotonic_clock.h"
#include "locd/frames/image_health.h"
#include "locd/pose/detection_watch.h"
#include "locd/pose/error_model.h"
#include "locd/pose/expected_windows.h"
#include "locd/pose/frame_detector.h"
#include "locd/pose/map_index.h"
#include "locd/pose/map_watch.h"
#include "locd/pose/riding_watch.h"
#include "locd/pose/robust_pose.h"
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
        detector(rig, map.catalog(options.inverted), options.detection_threads,
                 options.begin_worker),
        expected(rig, map),
        robust(rig, map, {}),
        gate(options.gate),
        motion(options.motion()),
        map_watch(map, robust.solver()),
        error_model(rig, map, map_watch, options.calibration_sigmas(), options.size_sigma),
        swap_watch(rig, map),
        riding_watch(map, robust.solver()),
        health(rig.cameras.size(), options.image_health()),
        skew_watch({options.triggered, options.negligible_skew}) {
    observations.reserve(kMaxObservations);
    others.reserve(kMaxObservations);
    all.reserve(kMaxObservations);
    alerts.reserve(kMaxObservations);
    candidates.reserve(2 * kMaxObservations);
    WAYMARK_CHECK(rig.cameras.size() >= 1 && rig.cameras.size() <= kMaxCameras);
    WAYMARK_CHECK(rig.cameras.size() == 1 || rig.has_extrinsics);
    WAYMARK_CHECK(options.check().has_value());
  }

  void localize(const FrameSetLease& set, PoseEstimate& estimate);
  void look_at_images(const FrameSetLease& set);
  void find_markers(const FrameSetLease& set, Stamp stamp);
  void find_candidates(const FrameSetLease& set);
  void observe(PoseEstimate& estimate);
  void observe(std::size_t camera, const Detection& detection, PoseEstimate& estimate);
  void time_observations(const FrameSetLease& set, PoseEstimate& estimate);
  void solve(const FrameSetLease& set, PoseEstimate& estimate);
  void report(const PoseSolution& solution, PoseEstimate& estimate) const;
  void judge(const FrameSetLease& set, const PoseSolution& solution,
             const std::optional<MotionPrediction>& prior, PoseEstimate& estimate);
  [[nodiscard]] bool some_camera_disagrees() const;
  void leave_suspects_out(PoseEstimate& estimate);
  void gather_all();
  void look_for_riding(Stamp stamp);
  void watch(const PoseSolution& solution, PoseEstimate& estimate);

  Rig rig;
  LocalizerOptions options;
  MapIndex map;
  FrameDetector detector;
  ExpectedWindows expected;
  RobustPose robust;
  PoseGate gate;
  MotionFilter motion;
  MapWatch map_watch;
  ErrorModel error_model;
  SwapWatch swap_watch;
  RidingWatch riding_watch;
  ImageHealth health;
  SkewWatch skew_watch;
  DetectionWatch detection_watch;
  CameraMask unhealthy_frames = 0;  ///< cameras of the set whose images are of no use
  CameraMask usable = 0;            ///< those whose images are of use, and could be searched
  /// A detection of the set, before it is known how many there are.
  struct Candidate {
    std::size_t camera;
    std::size_t index;  ///< among its camera's detections
    double area_px2;
  };
  std::vector<Candidate> candidates;
  std::vector<SetObservation> observations;
  std::vector<SetObservation> others;  ///< held against the pose, take no part in it
  std::vector<SetObservation> all;     ///< both
  std::vector<Alert> alerts;
};

void Localizer::Implementation::localize(const FrameSetLease& set, PoseEstimate& estimate) {
  alerts.clear();
  estimate.reset(PoseReason::no_markers, set);
  const Stamp started = monotonic_now();
  look_at_images(set);
  skew_watch.look(estimate.stamp, estimate.max_skew, alerts);
  find_markers(set, estimate.stamp);
  detection_watch.look(detector.searched(), detector.failed(), estimate.stamp, alerts);
  unhealthy_frames = set.cameras & ~usable;
  usable &= ~detector.failed();
  const Stamp detected = monotonic_now();
  find_candidates(set);
  observe(estimate);
  leave_suspects_out(estimate);
  time_observations(set, estimate);
  solve(set, estimate);
  estimate.times.detect = detected - started;
  estimate.times.solve = monotonic_now() - detected;
}

void Localizer::Implementation::look_at_images(const FrameSetLease& set) {
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    if (!set.has(c)) continue;
    const Frame& frame = set.frames[c];
    if (frame.has_image()) {
      health.look(c, frame.image(), frame.stamp(), alerts);
    } else if (frame.detections() != nullptr) {
      health.look(c, frame.detections()->detections, frame.stamp(), alerts);
    }
  }
  usable = set.cameras & ~health.unhealthy() & ~health.repeated();
}

/// Where they are expected at `stamp`, if that can be told.
void Localizer::Implementation::find_markers(const FrameSetLease& set, Stamp stamp) {
  if (options.guided) expected.predict(motion.predict(stamp));
  detector.detect(set, usable, expected.by_camera());
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    if ((detector.searched() & camera_bit(c)) != 0) {
      expected.remember(c, detector.detections_of(c));
    }
  }
}

/// The detections that are used, by camera: of more than kMaxObservations, the largest in the
/// image.
void Localizer::Implementation::find_candidates(const FrameSetLease& set) {
  candidates.clear();
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    if (!set.has(camera)) continue;
    const auto detections = detector.detections_of(camera);
    for (std::size_t i = 0; i < detections.size(); ++i) {
      candidates.push_back({camera, i, area_px2(detections[i].corners)});
    }
  }
  if (candidates.size() <= kMaxObservations) return;
  const auto end = candidates.begin() + kMaxObservations;
  std::nth_element(
      candidates.begin(), end, candidates.end(), [](const Candidate& a, const Candidate& b) {
        return std::tie(b.area_px2, a.camera, a.index) < std::tie(a.area_px2, b.camera, b.index);
      });
  candidates.erase(end, candidates.end());
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.camera, a.index) < std::tie(b.camera, b.index);
  });
}

/// Every candidate with what is known of its marker.
void Localizer::Implementation::observe(PoseEstimate& estimate) {
  observations.clear();
  others.clear();
  for (const Candidate& candidate : candidates) {
    const auto detections = detector.detections_of(candidate.camera);
    observe(candidate.camera, detections[candidate.index], estimate);
  }
  for (std::size_t i = 0; i < estimate.observations.size(); ++i) {
    const auto& seen = estimate.observations;
    const bool before =
        std::any_of(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(i),
                    [&](const ObservedMarker& other) { return other.marker == seen[i].marker; });
    estimate.markers_seen += before ? 0 : 1;
  }
}

void Localizer::Implementation::observe(std::size_t camera, const Detection& detection,
                                        PoseEstimate& estimate) {
  ObservedMarker seen;
  seen.marker = detection.marker;
  seen.camera = static_cast<std::int16_t>(camera);
  seen.corners_px = detection.corners;
  const auto of_camera = detector.detections_of(camera);
  const auto same_id = [&](const Detection& other) { return other.marker == detection.marker; };
  const auto map_index = map.find(detection.marker);
  if (!map_index) {
    seen.verdict = ObservationVerdict::unknown;
  } else if (std::count_if(of_camera.begin(), of_camera.end(), same_id) > 1) {
    seen.verdict = ObservationVerdict::repeated;
  } else {
    const bool use = !map.quarantined(*map_index);
    if (!use) seen.verdict = ObservationVerdict::quarantined;
    SetObservation& o = (use ? observations : others).emplace_back();
    o.observation.camera = static_cast<int>(camera);
    o.observation.size_m = map.marker(*map_index).size_m;
    o.detected_px = detection.corners;
    if (detection.covariances) {
      o.stated = *detection.covariances;
    } else {
      o.stated.fill(Eigen::Matrix2d::Zero());
    }
    if (!error_model.begun()) error_model.begin(detection.covariances.has_value());
    o.map_index = *map_index;
    o.report_index = estimate.observations.size();
  }
  estimate.observations.push_back(seen);
}

/// Cameras that were named take no part where the others show two markers.
void Localizer::Implementation::leave_suspects_out(PoseEstimate& estimate) {
  constexpr std::size_t kEnough = 2;
  const CameraMask suspects = error_model.suspects();
  if (suspects == 0) return;
  const auto is_sound = [&](const SetObservation& o) {
    return (suspects & camera_bit(static_cast<std::size_t>(o.observation.camera))) == 0;
  };
  const auto sound = std::count_if(observations.begin(), observations.end(), is_sound);
  if (static_cast<std::size_t>(sound) < kEnough) return;
  const auto end = std::stable_partition(observations.begin(), observations.end(), is_sound);
  for (auto o = end; o != observations.end(); ++o) {
    estimate.observations[o->report_index].verdict = ObservationVerdict::quarantined;
    others.push_back(*o);
  }
  observations.erase(end, observations.end());
}

/// The set's instant, and each corner's from there: the cameras' skew and their rows' read-out.
void Localizer::Implementation::time_observations(const FrameSetLease& set,
                                                  PoseEstimate& estimate) {
  CameraMask seeing = 0;
  for (const SetObservation& o : observations) {
    seeing |= camera_bit(static_cast<std::size_t>(o.observation.camera));
  }
  if (seeing != 0) {
    Stamp sum{0};
    int count = 0;
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
      if ((seeing & camera_bit(c)) == 0) continue;
      sum += set.frames[c].stamp() - estimate.set_stamp;
      ++count;
    }
    estimate.stamp = estimate.set_stamp + sum / count;
  }
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    if (set.has(c)) estimate.camera_offset[c] = set.frames[c].stamp() - estimate.stamp;
  }
  const auto time_corners = [&](SetObservation& o) {
    const RigCamera& camera = rig.cameras[static_cast<std::size_t>(o.observation.camera)];
    const double offset_s =
        in_s(estimate.camera_offset[static_cast<std::size_t>(o.observation.camera)]);
    const double readout_s = camera.readout_us.value_or(0) * 1e-6;
    const double rows = camera.model.parameters().height_px;
    for (std::size_t i = 0; i < 4; ++i) {
      // The stamp is of the middle row, (rows − 1)/2.
      o.row[i] = (o.detected_px[i].y() - 0.5 * (rows - 1)) / rows;
      o.after_s[i] = offset_s + readout_s * o.row[i];
    }
  };
  std::for_each(observations.begin(), observations.end(), time_corners);
  std::for_each(others.begin(), others.end(), time_corners);
}

void Localizer::Implementation::solve(const FrameSetLease& set, PoseEstimate& estimate) {
  if (observations.empty()) return;
  const auto prior = motion.predict(estimate.stamp);
  VelocityPrior velocity{Vector6d::Zero(), motion.unknown_velocity_covariance()};
  if (prior) velocity = {prior->velocity, prior->velocity_covariance};
  std::optional<Rigid3> predicted;
  if (prior) predicted = prior->world_from_rig;
  const auto solution = robust.solve(observations, predicted, velocity, error_model.known());
  if (!solution) {
    map_watch.look_at_fit(estimate.stamp, 0, static_cast<int>(observations.size()), alerts);
    gather_all();
    look_for_riding(estimate.stamp);
    error_model.learn_noise(estimate.stamp, all, nullptr, robust.solver(), alerts);
    estimate.lose_pose(PoseReason::no_solution);
    return;
  }
  report(*solution, estimate);
  map_watch.look_at_fit(estimate.stamp, solution->inlier_markers, solution->outlier_markers,
                        alerts);
  judge(set, *solution, prior, estimate);
  const Stamp judged = monotonic_now();
  robust.hold_against(others, *solution, error_model.known());
  watch(*solution, estimate);
  estimate.times.watch = monotonic_now() - judged;
}

void Localizer::Implementation::gather_all() {
  all.assign(observations.begin(), observations.end());
  all.insert(all.end(), others.begin(), others.end());
}

void Localizer::Implementation::look_for_riding(Stamp stamp) {
  for (const std::size_t map_index : riding_watch.look(all)) {
    map_watch.quarantine_riding(stamp, map_index, alerts);
    error_model.forget_evidence();
  }
}

void Localizer::Implementation::watch(const PoseSolution& solution, PoseEstimate& estimate) {
  for (const SetObservation& o : others) {
    ObservedMarker& seen = estimate.observations[o.report_index];
    seen.rms_px = o.rms_px;
    seen.sigmas_squared = o.sigmas_squared;
  }
  gather_all();
  look_for_riding(estimate.stamp);
  error_model.learn_noise(estimate.stamp, all, &solution, robust.solver(), alerts);
  if (estimate.has(PoseReason::no_velocity)) return;
  // A camera that stands elsewhere makes the pose jump between what it and what the others show.
  const CameraMask swapped_before = swap_watch.suspects();
  const auto told = static_cast<std::ptrdiff_t>(alerts.size());
  swap_watch.update(estimate.stamp, all, alerts);
  const auto of_swaps = static_cast<std::ptrdiff_t>(alerts.size());
  error_model.end_verdicts(estimate.stamp, swap_watch.suspects() & ~swapped_before, alerts);
  // What was said of them is over before the swap is told.
  std::rotate(alerts.begin() + told, alerts.begin() + of_swaps, alerts.end());
  const bool tells = !solution.ambiguous && !estimate.has(PoseReason::jump) &&
                     solution.inlier_markers >= 2 &&
                     solution.inlier_markers >= solution.outlier_markers;
  if (tells) error_model.update(estimate.stamp, all, solution, robust, alerts);
  if (estimate.has(PoseReason::jump)) return;
  map_watch.update(estimate.stamp, all, solution, swap_watch.trusted(), alerts);
  map_watch.forget_unknown(estimate.stamp, alerts);
  if (solution.ambiguous || solution.inlier_markers < 2) return;
  for (const ObservedMarker& seen : estimate.observations) {
    if (seen.verdict == ObservationVerdict::unknown) {
      map_watch.note_unknown(estimate.stamp, seen.marker, alerts);
    }
  }
}

void Localizer::Implementation::report(const PoseSolution& solution, PoseEstimate& estimate) const {
  estimate.reasons = 0;
  estimate.world_from_rig = solution.world_from_rig;
  estimate.covariance = solution.covariance;
  estimate.markers_used = solution.inlier_markers;
  estimate.observations_used = solution.inliers;
  double sum = 0;
  for (const SetObservation& o : observations) {
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

void Localizer::Implementation::judge(const FrameSetLease& set, const PoseSolution& solution,
                                      const std::optional<MotionPrediction>& prior,
                                      PoseEstimate& estimate) {
  if (!prior) gate.forget();
  ReasonBits reasons = gate.judge(estimate.stamp, solution, prior);
  const bool trusted = reasons == 0 || reasons == bit(PoseReason::sigma);
  // In a ring of cameras one swap looks like another one, seen from a rig that is turned: what the
  // others see is no better then.
  if ((error_model.suspects() & estimate.cameras_used) != 0 || swap_watch.suspects() != 0 ||
      some_camera_disagrees()) {
    reasons |= bit(PoseReason::camera_suspect);
  }
  if (error_model.undecided() || contradicts_itself(solution)) {
    reasons |= bit(PoseReason::misfit);
  }
  if (usable != set.expected) reasons |= bit(PoseReason::camera_missing);
  Stamp readout{0};
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    if (!set.has(c)) continue;
    const double readout_us = rig.cameras[c].readout_us.value_or(0);
    readout = std::max(readout, from_us(readout_us));
    if (set.frames[c].info().quality == StampQuality::arrival) {
      reasons |= bit(PoseReason::unsynced);
    }
  }
  if (options.triggered && estimate.max_skew > options.negligible_skew) {
    reasons |= bit(PoseReason::skew);
  }
  const bool needs_velocity = estimate.max_skew + readout > options.negligible_skew;
  if (needs_velocity && !(prior && prior->velocity_known)) {
    reasons |= bit(PoseReason::no_velocity);
  }
  estimate.resets = gate.resets();
  if (map_watch.wrong_map()) reasons |= bit(PoseReason::wrong_map);
  estimate.reasons = reasons;
  estimate.status = reasons == 0 ? PoseStatus::ok

                    : solution.ambiguous || solution.rivals ? PoseStatus::ambiguous
                                                            : PoseStatus::degraded;
  if (trusted) motion.update(estimate.stamp, solution.motion);
  const auto now = motion.predict(estimate.stamp);
  if (now && now->velocity_known) estimate.velocity = now->velocity;
}

/// Whether a camera's markers are mostly outliers: the pose is by others then, and who is right is
/// not known.
bool Localizer::Implementation::some_camera_disagrees() const {
  std::array<int, kMaxCameras> markers{};
  std::array<int, kMaxCameras> inliers{};
  for (const SetObservation& o : observations) {
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

CameraMask Localizer::left_out(DropReason why) const {
  switch (why) {
    case DropReason::unhealthy:
      return implementation_->unhealthy_frames;
    case DropReason::unsearched:
      return implementation_->detector.failed();
    default:
      return 0;
  }
}

CameraMask Localizer::unhealthy_cameras() const { return implementation_->health.unhealthy(); }

void Localizer::remember_images_of(const Localizer& before) {
  implementation_->health.remember_images_of(before.implementation_->health);
}

void Localizer::forget_motion() {
  implementation_->motion.reset();
  implementation_->gate.forget();
}

}  // namespace waymark
