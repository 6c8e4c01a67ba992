#include "locd/pose/error_model.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/check.h"

namespace waymark {
namespace {

/// Beyond, an observation's fault is not linear: it is looked for in other ways.
constexpr double kLinear_m = 0.35;
constexpr double kLinear_rad = 0.25;
/// Observations of a camera that can tell what is wrong with it.
constexpr int kCameraViews = 24;
/// Blocks of evidence that tell whether a verdict still holds.
constexpr int kBlocksToRevoke = 4;
/// Different markers in which a camera's fault shows, of a map of at least twice as many: fewer may
/// have moved together, which looks alike.
constexpr int kCameraMarkers = 8;
/// Kinds of faults of a camera.
constexpr std::size_t kKindsOfCamera = 4;
/// Newer observations that can speak against a verdict.
constexpr int kViewsToRevoke = 8;

bool is_linear(const ErrorColumns& columns) {
  Matrix6d information = columns.by_marker.transpose() * columns.by_marker;
  information.diagonal().array() += 1e-6;
  const Vector6d moved = information.ldlt().solve(columns.by_marker.transpose() * columns.residual);
  return moved.head<3>().norm() < kLinear_m && moved.tail<3>().norm() < kLinear_rad;
}

}  // namespace

Status ErrorModelOptions::check() const {
  return RangeCheck()
      .field("gain", gain, {5, 100})
      .field("lead", lead, {2, 50})
      .field("over_gain", over_gain, {-20, 0})
      .field("chi2", chi2, {20, 500})
      .field("marker_m", marker_m, {0.001, 1})
      .field("marker_rad", marker_rad, {0.002, 0.5})
      .field("camera_m", camera_m, {0.001, 1})
      .field("camera_rad", camera_rad, {0.001, 0.2})
      .field("sets_per_look", sets_per_look, {1, 100})
      .field("fewest_views", fewest_views, {2, 100})
      .status();
}

ErrorModel::ErrorModel(const Rig& rig, const MapIndex& map, MapWatch& markers,
                       const CalibrationPrior& prior, const ErrorModelOptions& options)
    : rig_(rig),
      map_(map),
      markers_(markers),
      options_(options),
      prior_(prior),
      known_{{}, prior, prior},
      noise_(map, rig.cameras.size()),
      evidence_(prior),
      of_suspects_(prior, kBlocksToRevoke + 1),
      explanations_(prior, map),
      filter_(prior, map) {
  WAYMARK_CHECK(options.check().has_value());
  rows_.reserve(kMaxObservations);
  waiting_.observations.reserve(kMaxObservations);
  const std::size_t most = kKindsOfCamera * rig.cameras.size();
  verdicts_.reserve(most);
  believed_.reserve(most + Evidence::kMostMarkers);
  evidence_.sum(1, system_);
}

void ErrorModel::begin(bool covariances_stated) {
  noise_.begin(covariances_stated);
  believe();
}

void ErrorModel::learn_noise(Stamp stamp, std::span<const SetObservation> observations,
                             const PoseSolution* solution, const RigPoseSolver& solver,
                             std::vector<Alert>& alerts) {
  noise_.learn(stamp, observations, solution, solver, alerts);
  known_.noise_px = noise_.sigmas_px();
}

/// Prior and noise for the next set.
void ErrorModel::believe() {
  known_.noise_px = noise_.sigmas_px();
  known_.calibration = prior_;
  known_.learnt = filter_.known();
  for (const Verdict& verdict : verdicts_) {
    const auto camera = static_cast<std::size_t>(verdict.what.camera);
    const CalibrationVector widths = Explanations::widths_of(verdict.what.kind);
    known_.calibration.widen(camera, widths);
    known_.learnt.widen(camera, widths);
  }
}

std::optional<ErrorColumns> ErrorModel::columns_of(const SetObservation& o,
                                                   ObservationGeometry geometry,
                                                   const Vector6d& velocity) const {
  const CornerTimes times{o.after_s, o.row};
  auto columns = error_columns(o.observation, geometry, times, velocity);
  const auto nearer = [&](const std::optional<ErrorColumns>& there) {
    return there && !(columns && columns->residual.norm() < there->residual.norm());
  };
  const Vector6d& moved = markers_.offset_of(o.map_index);
  if (!moved.isZero()) {
    geometry.world_from_marker = geometry.world_from_marker.plus(moved);
    auto there = error_columns(o.observation, geometry, times, velocity);
    if (!nearer(there)) return columns;
    there->residual += there->by_marker * moved;
    return there;
  }
  for (const Verdict& verdict : verdicts_) {
    if (verdict.what.camera != o.observation.camera) continue;
    const Vector6d fault = verdict.fault.head<6>();
    geometry.cam_from_rig = geometry.cam_from_rig.inverse().plus(fault).inverse();
    auto there = error_columns(o.observation, geometry, times, velocity);
    if (!nearer(there)) return columns;
    there->residual += there->by_camera.leftCols<6>() * fault;
    return there;
  }
  return columns;
}

void ErrorModel::make_rows(const Waiting& set, const Motion& motion, const RobustPose& robust) {
  rows_.clear();
  distance_m_ = 0;
  const RigPoseSolver& solver = robust.solver();
  for (const SetObservation& o : set.observations) {
    if (markers_.rides(o.map_index)) continue;
    const auto camera = static_cast<std::size_t>(o.observation.camera);
    const auto geometry = solver.geometry(o.observation.camera, set.solution.world_from_rig,
                                          map_.marker(o.map_index).world_from_marker);
    auto columns = columns_of(o, geometry, motion.velocity);
    if (!columns) continue;
    // A corner's instant is another than the set's by so much; just then the velocity was another.
    const Vector8d shown = columns->by_pose * motion.unsure;
    columns->whiten(noise_covariance(o, known_.noise_px[camera]) +
                    known_.learnt.squared_time(camera, mean_row(o)) * shown * shown.transpose());
    if (!is_linear(*columns)) continue;
    rows_.push_back({o.map_index, camera, prior_.size_of(map_.marker(o.map_index)), *columns});
    distance_m_ +=
        (geometry.world_from_marker.translation - set.solution.world_from_rig.translation).norm();
  }
  distance_m_ /= static_cast<double>(std::max<std::size_t>(rows_.size(), 1));
}

void ErrorModel::update(Stamp stamp, std::span<const SetObservation> observations,
                        const PoseSolution& solution, const RobustPose& robust,
                        std::vector<Alert>& alerts) {
  constexpr Stamp kGap = std::chrono::milliseconds(500);
  std::optional<std::pair<Stamp, Rigid3>> before;
  if (waiting_.there && stamp > waiting_.stamp && stamp - waiting_.stamp < kGap) {
    before = {waiting_.stamp, waiting_.solution.world_from_rig};
    gather(waiting_, motion_of(waiting_, stamp, solution.world_from_rig), robust, alerts);
  }
  waiting_.stamp = stamp;
  waiting_.observations.assign(observations.begin(), observations.end());
  waiting_.solution = solution;
  waiting_.before = before;
  waiting_.there =
      std::all_of(observations.begin(), observations.end(), [&](const SetObservation& o) {
        return noise_.settled(static_cast<std::size_t>(o.observation.camera));
      });
}

ErrorModel::Motion ErrorModel::motion_of(const Waiting& set, Stamp next,
                                         const Rigid3& next_world_from_rig) {
  const Rigid3& here = set.solution.world_from_rig;
  const Vector6d after = next_world_from_rig.minus(here) / in_s(next - set.stamp);
  if (!set.before) return {after, after};
  const Vector6d before = here.minus(set.before->second) / in_s(set.stamp - set.before->first);
  return {0.5 * (before + after), 0.5 * (after - before)};
}

void ErrorModel::gather(const Waiting& set, const Motion& motion, const RobustPose& robust,
                        std::vector<Alert>& alerts) {
  if (question_ && explanations_.advance()) answer(set.stamp, alerts);
  make_rows(set, motion, robust);
  const Rigid3& world_from_rig = set.solution.world_from_rig;
  if (rows_.size() < 2 || !evidence_.is_new(world_from_rig, distance_m_)) return;
  const long before = evidence_.sets();
  add_evidence(world_from_rig);
  if (evidence_.sets() == before) return;
  const long sets = evidence_.sets() - forgotten_;
  const bool early = sets == 2 || sets == 4;
  look_due_ = look_due_ || early || sets % options_.sets_per_look == 0;
  if (question_ || (learn_calibration(set.stamp) && !early)) return;
  ask();
  if (!question_ || !early) return;
  while (!explanations_.advance()) {
  }
  answer(set.stamp, alerts);
}

/// A block is believed when newer ones have named nobody.
bool ErrorModel::learn_calibration(Stamp stamp) {
  constexpr int kNewerBlocks = 3;
  const long number = evidence_.number_of(kNewerBlocks);
  if (number <= learnt_block_) return false;
  learnt_block_ = number;
  if (undecided() || !options_.learns_calibration) return false;
  evidence_.block(kNewerBlocks, system_);
  static_cast<void>(filter_.take(system_, stamp));
  believe();
  return true;
}

void ErrorModel::add_evidence(const Rigid3& world_from_rig) {
  if (!suspects_are_apart()) {
    evidence_.add(world_from_rig, rows_);
    return;
  }
  of_suspects_.add(world_from_rig, rows_);
  const CameraMask suspect = suspects();
  const auto others = std::partition(rows_.begin(), rows_.end(), [&](const EvidenceRow& row) {
    return (suspect & camera_bit(row.camera)) == 0;
  });
  evidence_.add(world_from_rig, std::span(rows_.begin(), others));
}

/// By turns: what explains the newest sets, and whether a verdict still holds.
void ErrorModel::ask() {
  if (back_due_) {
    back_due_ = false;
    if (ask_of_a_verdict()) return;
  }
  if (!look_due_) return;
  look_due_ = false;
  back_due_ = true;
  constexpr std::array<int, 6> kWindows{1, 2, 4, 1, 2, 16};
  question_ = {kWindows[static_cast<std::size_t>(looks_++) % kWindows.size()], std::nullopt};
  evidence_.sum(question_->blocks, system_);
  believe_quarantine();
  explanations_.begin(system_, prior_, believed_);
}

/// False: nobody is named.
bool ErrorModel::ask_of_a_verdict() {
  evidence_of_verdicts().sum(kBlocksToRevoke, system_);
  believe_quarantine();
  if (believed_.empty()) return false;
  const Explanation asked = believed_[static_cast<std::size_t>(looks_back_++) % believed_.size()];
  std::erase(believed_, asked);
  question_ = {kBlocksToRevoke, asked};
  explanations_.begin(system_, prior_, believed_);
  return true;
}

void ErrorModel::answer(Stamp stamp, std::vector<Alert>& alerts) {
  const Question question = *question_;
  question_.reset();
  if (question.asked) {
    judge_verdict(stamp, *question.asked, alerts);
  } else {
    judge_explanations(stamp, question.blocks, alerts);
  }
}

void ErrorModel::believe_quarantine() {
  believed_.clear();
  for (const Verdict& verdict : verdicts_) believed_.push_back(verdict.what);
  for (std::size_t slot = 0; slot < system_.views.size(); ++slot) {
    if (!map_.quarantined(system_.markers[slot])) continue;
    believed_.push_back({AlertKind::marker_moved, -1, system_.markers[slot]});
  }
}

/// Whether a fault is large enough, and well enough known, to be named.
bool ErrorModel::nameable(const Score& score) const {
  if (score.chi2 < options_.chi2) return false;
  if (score.what.of_marker()) {
    return score.views >= options_.fewest_views &&
           (score.marker.head<3>().norm() >= options_.marker_m ||
            score.marker.tail<3>().norm() >= options_.marker_rad);
  }
  const int fewest = std::min(kCameraMarkers, static_cast<int>(map_.size() / 2));
  if (score.views < kCameraViews || score.markers < fewest) return false;
  if (score.what.kind != AlertKind::extrinsics_off) return true;
  return score.camera.head<3>().norm() >= options_.camera_m ||
         score.camera.segment<3>(3).norm() >= options_.camera_rad;
}

/// Of the newest blocks: which explanation is the clear winner, if any.
void ErrorModel::judge_explanations(Stamp stamp, int blocks, std::vector<Alert>& alerts) {
  const unsigned window = 1U << static_cast<unsigned>(blocks);
  undecided_ &= ~window;
  const Score* best = nullptr;
  const Score* next = nullptr;
  for (const Score& score : explanations_.scores()) {
    if (std::find(believed_.begin(), believed_.end(), score.what) != believed_.end()) continue;
    (best == nullptr ? best : next) = &score;
    if (next != nullptr) break;
  }
  if (best == nullptr || best->gain < options_.gain) return;
  undecided_ |= window;
  const bool clear = next == nullptr || best->gain >= next->gain + options_.lead;
  if (!clear || !nameable(*best)) return;
  const Score found = *best;
  // Where something changed within these sets, what explains their mixture is not what is wrong.
  if (contradicted_by_a_block(evidence_, found.what)) return;
  name(stamp, found, alerts);
}

/// Of the two newest blocks, a new one that holds hardly anything passed over.
bool ErrorModel::contradicted_by_a_block(const Evidence& evidence, const Explanation& what) {
  evidence.block(0, system_);
  const int newest = system_.sets < options_.sets_per_look / 2 ? 1 : 0;
  return contradicted_by_block(evidence, newest, what) ||
         contradicted_by_block(evidence, newest + 1, what);
}

bool ErrorModel::contradicted_by_block(const Evidence& evidence, int age, const Explanation& what) {
  evidence.block(age, system_);
  if (system_.sets < options_.sets_per_look / 2) return true;
  believe_quarantine();
  const auto scores = explanations_.judge(system_, prior_, believed_);
  const auto own = explanations_.score_of(what);
  if (own && own->gain < 0) return true;
  const auto other = std::find_if(scores.begin(), scores.end(), [&](const Score& score) {
    return std::find(believed_.begin(), believed_.end(), score.what) == believed_.end();
  });
  const bool more = other != scores.end() && other->gain > (own ? own->gain : 0) + options_.lead;
  if (!more) return false;
  // Beside what explains more it may still be needed: then both are wrong.
  believed_.push_back(other->what);
  static_cast<void>(explanations_.judge(system_, prior_, believed_));
  const auto beside = explanations_.score_of(what);
  return !beside || beside->gain < options_.lead;
}

/// Whether a verdict would be given again.
void ErrorModel::judge_verdict(Stamp stamp, const Explanation& asked, std::vector<Alert>& alerts) {
  const auto own = explanations_.score_of(asked);
  if (!own || own->views < kViewsToRevoke) return;
  if (own->gain < options_.over_gain) {
    take_back(stamp, asked, alerts);
    return;
  }
  const Score first = explanations_.scores().front();
  if (first.what == asked || first.gain < std::max(own->gain, 0.0) + options_.lead) return;
  const bool sure = nameable(first) && !contradicted_by_a_block(evidence_of_verdicts(), first.what);
  if (sure) take_back(stamp, asked, alerts);
}

void ErrorModel::name(Stamp stamp, const Score& score, std::vector<Alert>& alerts) {
  // What was gathered before something went wrong does not fit what is known now.
  forget_evidence();
  if (!score.what.of_marker()) filter_.reset();
  if (score.what.of_marker()) {
    markers_.quarantine(stamp, score.what.map_index, score.marker, alerts);
  } else {
    name_camera(stamp, score, alerts);
  }
}

void ErrorModel::name_camera(Stamp stamp, const Score& score, std::vector<Alert>& alerts) {
  Alert alert;
  alert.kind = score.what.kind;
  alert.stamp = stamp;
  alert.camera = score.what.camera;
  if (score.what.kind == AlertKind::extrinsics_off) {
    alert.offset_m = score.camera.head<3>().norm();
    alert.offset_rad = score.camera.segment<3>(3).norm();
  } else {
    const int number = score.what.kind == AlertKind::lens_off        ? kFocal
                       : score.what.kind == AlertKind::stamps_skewed ? kStamp
                                                                     : kReadout;
    alert.value = score.camera[number];
    alert.sigma = score.camera_sigma[number];
  }
  alerts.push_back(alert);
  verdicts_.push_back({score.what, score.camera, alert});
  believe();
}

void ErrorModel::take_back(Stamp stamp, const Explanation& what, std::vector<Alert>& alerts) {
  forget_evidence();
  if (what.of_marker()) {
    markers_.release(stamp, what.map_index, alerts);
    return;
  }
  const auto verdict = std::find_if(verdicts_.begin(), verdicts_.end(),
                                    [&](const Verdict& v) { return v.what == what; });
  Alert alert = verdict->alert;
  alert.raised = false;
  alert.stamp = stamp;
  alert.offset_m = alert.offset_rad = alert.value = alert.sigma = Alert{}.value;
  alerts.push_back(alert);
  verdicts_.erase(verdict);
  believe();
}

void ErrorModel::forget_evidence() {
  evidence_.clear();
  of_suspects_.clear();
  forgotten_ = evidence_.sets();
  waiting_.there = false;
  question_.reset();
  look_due_ = back_due_ = false;
  undecided_ = 0;
}

void ErrorModel::end_verdicts(Stamp stamp, CameraMask cameras, std::vector<Alert>& alerts) {
  for (std::size_t i = verdicts_.size(); i-- > 0;) {
    const Explanation what = verdicts_[i].what;
    if ((cameras & camera_bit(static_cast<std::size_t>(what.camera))) != 0) {
      take_back(stamp, what, alerts);
    }
  }
}

CameraMask ErrorModel::suspects() const {
  CameraMask mask = 0;
  for (const Verdict& verdict : verdicts_) {
    mask |= camera_bit(static_cast<std::size_t>(verdict.what.camera));
  }
  return mask;
}

}  // namespace waymark
