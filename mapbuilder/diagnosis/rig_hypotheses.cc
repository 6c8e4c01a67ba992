#include "mapbuilder/diagnosis/rig_hypotheses.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>

#include "core/base/check.h"
#include "core/base/median.h"
#include "core/base/range.h"
#include "mapbuilder/diagnosis/rig_agreement.h"
#include "mapbuilder/diagnosis/rig_path.h"

namespace waymark {
namespace {

/// Instants that hypotheses are compared on; of more, every n-th.
constexpr std::size_t kMaxInstants = 160;
/// Fewer instants with two cameras tell nothing apart.
constexpr std::size_t kMinInstants = 3;
/// 2 Δ ln L that a hypothesis must gain on the stated rig, and stand above the next cause.
constexpr double kMinGain = 20.0;
constexpr double kMinLead = 10.0;
/// A cause explains at least a third of the misfit; less is a calibration that could be better.
constexpr double kMinCostRatio = 1.5;
/// As a camera's number: every one.
constexpr int kAllCameras = -2;

double degrees(double rad) { return rad * 180.0 / std::numbers::pi; }
double milliseconds(double seconds) { return seconds * 1e3; }

/// One way to explain the tracks, with what it costs.
struct Hypothesis {
  RigExplanation explanation;
  std::shared_ptr<const CameraTracks> tracks;  ///< as they would be without a fault of time
  Extrinsics rig;                              ///< from `since` on, or throughout
  Extrinsics rig_before;                       ///< before `since`
  std::size_t since = 0;                       ///< instant
  int free_camera = -1;                        ///< its place is fitted, whatever is stated
  int numbers = 0;                             ///< that it frees
  double cost = 0;                             ///< sigmas²
  bool listed = true;  ///< one of few ways to write a file wrongly: no number is fitted
};

class RigJudge {
 public:
  RigJudge(const CameraTracks& tracks, const Rig& stated, const ExtrinsicSigmas& sigmas)
      : as_seen_(std::make_shared<const CameraTracks>(tracks)),
        tracks_(*as_seen_),
        names_(tracks_.cameras) {
    for (const RigCamera& camera : stated.cameras) stated_.push_back(camera.rig_from_cam);
    Vector6d sigma;
    sigma << Eigen::Vector3d::Constant(sigmas.position_m),
        Eigen::Vector3d::Constant(sigmas.rotation_rad);
    prior_ = sigma.cwiseAbs2().cwiseInverse();
    std::vector<std::size_t> seen;
    for (std::size_t i = 0; i < tracks_.instants.size(); ++i) {
      const auto& places = tracks_.instants[i].places;
      if (std::count_if(places.begin(), places.end(),
                        [](const auto& p) { return p.has_value(); }) >= 2) {
        seen.push_back(i);
      }
    }
    const std::size_t every = 1 + seen.size() / (kMaxInstants + 1);
    for (std::size_t i = 0; i < seen.size(); i += every) judged_.push_back(seen[i]);
  }

  std::optional<RigExplanation> explain() {
    if (judged_.size() < kMinInstants || stated_.size() < 2) return std::nullopt;
    noise_scale_ = 4.0;
    std::vector<Hypothesis> all = judge_all();
    double scale = std::numeric_limits<double>::infinity();
    for (const Hypothesis& h : all) scale = std::min(scale, noise_scale_of(h));
    noise_scale_ = std::clamp(scale, 1.0, 50.0);
    all = judge_all();
    return verdict(std::move(all));
  }

 private:
  std::size_t cameras() const { return stated_.size(); }

  // ---- fits ------------------------------------------------------------------------------------

  /// Cost of the instants [first, last) of those judged under one rig.
  double cost_of(const CameraTracks& tracks, const Extrinsics& rig, std::size_t first,
                 std::size_t last) const {
    double cost = 0;
    for (std::size_t j = first; j < last; ++j) {
      cost += agree(tracks.instants[judged_[j]], rig, noise_scale_).cost;
    }
    return cost;
  }

  std::vector<double> costs_of(const CameraTracks& tracks, const Extrinsics& rig) const {
    std::vector<double> costs;
    for (const std::size_t i : judged_) {
      costs.push_back(agree(tracks.instants[i], rig, noise_scale_).cost);
    }
    return costs;
  }

  /// The rig near `start` that fits the instants [first, last) best, each camera held by the
  /// calibration's sigmas but `free_camera`. Rig poses and cameras in turn.
  Extrinsics fit(const CameraTracks& tracks, const Extrinsics& start, int free_camera,
                 std::size_t first, std::size_t last) const {
    Extrinsics rig = start;
    constexpr int kRounds = 6;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<Matrix6d> hessian(cameras(), Matrix6d::Zero());
      std::vector<Vector6d> gradient(cameras(), Vector6d::Zero());
      for (std::size_t j = first; j < last; ++j) {
        const CameraTracks::Instant& instant = tracks.instants[judged_[j]];
        const InstantAgreement agreement = agree(instant, rig, noise_scale_);
        if (agreement.cameras < 2) continue;
        for (std::size_t k = 0; k < cameras(); ++k) {
          if (instant.places[k]) {
            add_place(*instant.places[k], *agreement.world_from_rig, rig[k], hessian[k],
                      gradient[k]);
          }
        }
      }
      for (std::size_t k = 0; k < cameras(); ++k) {
        if (!is_free(k, free_camera)) {
          hessian[k].diagonal() += prior_;
          gradient[k] -= prior_.cwiseProduct(rig[k].minus(start[k]));
        } else {
          hessian[k].diagonal() += 1e-6 * prior_;
        }
        const Vector6d delta = hessian[k].ldlt().solve(gradient[k]);
        if (delta.allFinite()) rig[k] = rig[k].plus(delta);
      }
    }
    return rig;
  }

  /// The first camera is what the others stand against where all are free.
  static bool is_free(std::size_t camera, int free_camera) {
    return free_camera == kAllCameras ? camera > 0 : static_cast<int>(camera) == free_camera;
  }

  void add_place(const TrackedPlace& place, const Rigid3& world_from_rig,
                 const Rigid3& rig_from_cam, Matrix6d& hessian, Vector6d& gradient) const {
    const Rigid3 predicted = world_from_rig * rig_from_cam;
    const double squared = squared_misfit(place, predicted, noise_scale_);
    const double weight = std::exp(-squared / 36.0) / (noise_scale_ * noise_scale_);
    const Matrix6d turn = left_motion_jacobian(world_from_rig);
    const Matrix6d weighted = weight * turn.transpose() * place.information;
    hessian += weighted * turn;
    gradient += weighted * place.world_from_cam.minus(predicted);
  }

  /// What leaving the stated calibration costs.
  double prior_cost(const Extrinsics& rig, const Extrinsics& start, int free_camera) const {
    double cost = 0;
    for (std::size_t k = 0; k < cameras(); ++k) {
      if (is_free(k, free_camera)) continue;
      const Vector6d delta = rig[k].minus(start[k]);
      cost += delta.dot(prior_.cwiseProduct(delta));
    }
    return cost;
  }

  /// The place of a camera on the rig that most instants of [first, last) agree on, given where the
  /// other cameras put the rig.
  std::optional<Rigid3> place_by_others(const CameraTracks& tracks, int camera, std::size_t first,
                                        std::size_t last) const {
    struct Sight {
      const TrackedPlace* place;
      Rigid3 world_from_rig;
    };
    std::vector<Sight> sights;
    for (std::size_t j = first; j < last; ++j) {
      const CameraTracks::Instant& instant = tracks.instants[judged_[j]];
      const auto& place = instant.places[static_cast<std::size_t>(camera)];
      if (!place) continue;
      const InstantAgreement others = agree(instant, stated_, noise_scale_, camera);
      if (others.world_from_rig) sights.push_back({&*place, *others.world_from_rig});
    }
    constexpr std::size_t kMaxCandidates = 60;
    const std::size_t every = 1 + sights.size() / (kMaxCandidates + 1);
    std::optional<Rigid3> best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < sights.size(); i += every) {
      const Rigid3 candidate = sights[i].world_from_rig.inverse() * sights[i].place->world_from_cam;
      double cost = 0;
      for (const Sight& s : sights) {
        cost += bounded_misfit(
            squared_misfit(*s.place, s.world_from_rig * candidate, 2.0 * noise_scale_));
      }
      if (cost < least) {
        least = cost;
        best = candidate;
      }
    }
    return best;
  }

  /// Fits what the calibration leaves open, unless the hypothesis is no better than the stated rig
  /// before that.
  void evaluate(Hypothesis& h, const Extrinsics& start, int free_camera = -1) const {
    constexpr double kWorthFitting = 0.95;
    h.rig = start;
    h.cost = cost_of(*h.tracks, start, 0, judged_.size());
    if (h.cost < kWorthFitting * stated_cost_) {
      h.rig = fit(*h.tracks, start, free_camera, 0, judged_.size());
      h.cost = cost_of(*h.tracks, h.rig, 0, judged_.size()) + prior_cost(h.rig, start, free_camera);
    }
    h.rig_before = h.rig;
    h.explanation.rig_from_cam = h.rig;
  }

  /// The noise that a hypothesis leaves, as a factor on the stated one; by the median, so that
  /// instants that it does not explain have no say.
  double noise_scale_of(const Hypothesis& h) const {
    std::vector<double> squared;
    for (std::size_t j = 0; j < judged_.size(); ++j) {
      const CameraTracks::Instant& instant = h.tracks->instants[judged_[j]];
      const Extrinsics& rig = judged_[j] >= h.since ? h.rig : h.rig_before;
      const InstantAgreement agreement = agree(instant, rig, noise_scale_);
      if (agreement.cameras < 2) continue;
      const double share = 1.0 - 1.0 / agreement.cameras;
      for (std::size_t k = 0; k < cameras(); ++k) {
        if (!instant.places[k]) continue;
        squared.push_back(
            squared_misfit(*instant.places[k], *agreement.world_from_rig * rig[k], 1.0) / share);
      }
    }
    if (squared.empty()) return std::numeric_limits<double>::infinity();
    return std::sqrt(upper_median(squared) / kMedianOfChi2_6);
  }

  // ---- hypotheses ------------------------------------------------------------------------------

  std::vector<Hypothesis> judge_all() {
    std::vector<Hypothesis> all;
    all.push_back(as_stated());
    add_inverted(all);
    add_exchanged(all);
    add_turned(all);
    add_scaled(all);
    for (std::size_t k = 0; k < cameras(); ++k) {
      if (cameras() == 2 && k == 0) continue;  // of two, only how they stand to each other is known
      add_late(all, static_cast<int>(k));
      add_out_of_step(all, static_cast<int>(k));
      add_bumped(all, static_cast<int>(k));
      add_displaced(all, static_cast<int>(k));
    }
    if (cameras() > 2) add_all_displaced(all);
    return all;
  }

  Hypothesis as_stated() {
    stated_cost_ = std::numeric_limits<double>::infinity();
    Hypothesis h;
    h.tracks = as_seen_;
    evaluate(h, stated_);
    stated_cost_ = cost_of(tracks_, stated_, 0, judged_.size());
    return h;
  }

  void add_listed(std::vector<Hypothesis>& all, Cause cause, std::vector<std::size_t> concerned,
                  const Extrinsics& rig, std::string detail, std::string remedy) const {
    Hypothesis h;
    h.tracks = as_seen_;
    h.explanation.cause = cause;
    h.explanation.cameras = std::move(concerned);
    h.explanation.detail = std::move(detail);
    h.explanation.remedy = std::move(remedy);
    evaluate(h, rig);
    all.push_back(std::move(h));
  }

  /// Chains of T_cn_cnm1 with the links marked written the other way round.
  Extrinsics with_inverted_links(const std::vector<char>& inverted) const {
    Extrinsics rig = stated_;
    for (std::size_t n = 1; n < cameras(); ++n) {
      const Rigid3 before_from_cam = stated_[n - 1].inverse() * stated_[n];
      rig[n] = rig[n - 1] * (inverted[n] != 0 ? before_from_cam.inverse() : before_from_cam);
    }
    return rig;
  }

  void add_inverted(std::vector<Hypothesis>& all) const {
    const std::string remedy =
        "Invert the transform in rig.yaml: T_cn_cnm1 takes points of camera n-1 into camera n.";
    const std::vector<std::size_t> every = all_but_first();
    add_listed(all, Cause::rig_inverted, every,
               with_inverted_links(std::vector<char>(cameras(), 1)),
               "T_cn_cnm1 is written the other way round", remedy);
    if (cameras() > 2) {
      for (std::size_t n = 1; n < cameras(); ++n) {
        std::vector<char> one(cameras(), 0);
        one[n] = 1;
        add_listed(all, Cause::rig_inverted, {n}, with_inverted_links(one),
                   "T_cn_cnm1 is written the other way round", remedy);
      }
    }
    const bool body = squared_distance_to_identity(stated_.front()) > 1e-12;
    if (body) {
      Extrinsics rig;
      for (const Rigid3& x : stated_) rig.push_back(x.inverse());
      std::vector<std::size_t> concerned(cameras());
      std::iota(concerned.begin(), concerned.end(), std::size_t{0});
      add_listed(all, Cause::rig_inverted, concerned, rig,
                 "T_cam_imu is written the other way round (T_imu_cam)",
                 "Invert T_cam_imu in rig.yaml: it takes points of the body into the camera.");
    }
  }

  static double squared_distance_to_identity(const Rigid3& x) {
    return x.minus(Rigid3{}).squaredNorm();
  }

  void add_exchanged(std::vector<Hypothesis>& all) const {
    for (std::size_t i = 0; i < cameras(); ++i) {
      for (std::size_t j = i + 1; j < cameras(); ++j) {
        Extrinsics rig = stated_;
        std::swap(rig[i], rig[j]);
        add_listed(all, Cause::rig_exchanged, {i, j}, rig,
                   "each stands where rig.yaml has the other",
                   "Exchange their folders or plugs, and name cameras by serial number.");
      }
    }
  }

  void add_turned(std::vector<Hypothesis>& all) const {
    for (const int angle : {90, 180, 270}) {
      const Rigid3 turn{Eigen::Quaterniond(Eigen::AngleAxisd(angle * std::numbers::pi / 180.0,
                                                             Eigen::Vector3d::UnitZ())),
                        Eigen::Vector3d::Zero()};
      Extrinsics every = stated_;
      for (Rigid3& x : every) x = x * turn;
      std::vector<std::size_t> concerned(cameras());
      std::iota(concerned.begin(), concerned.end(), std::size_t{0});
      add_listed(
          all, angle == 180 ? Cause::images_turned : Cause::rig_turned, concerned, every,
          fmt::format("all images are turned by {}° against rig.yaml", angle),
          "See whether the driver turns images; switch that off, or correct the rotations in "
          "rig.yaml.");
      for (std::size_t k = 0; k < cameras(); ++k) {
        Extrinsics rig = stated_;
        rig[k] = rig[k] * turn;
        add_listed(
            all, Cause::rig_turned, {k}, rig,
            fmt::format("it is turned by {}° about its optical axis against rig.yaml", angle),
            "See which way up it hangs and whether its driver turns images; correct its "
            "rotation in rig.yaml.");
      }
    }
  }

  Extrinsics scaled(double factor) const {
    Extrinsics rig = stated_;
    for (Rigid3& x : rig) {
      x.translation =
          stated_.front().translation + factor * (x.translation - stated_.front().translation);
    }
    return rig;
  }

  /// Baselines that fit times those stated.
  void add_scaled(std::vector<Hypothesis>& all) const {
    const auto cost = [&](double log_factor) {
      return cost_of(tracks_, scaled(std::exp(log_factor)), 0, judged_.size());
    };
    constexpr double kMost = 7.6;  // a factor of 2,000
    constexpr double kStep = 0.08;
    double best = 0;
    constexpr std::size_t kCoarse = 40;  // instants that tell the factor roughly
    const std::size_t every = 1 + judged_.size() / (kCoarse + 1);
    const auto coarse_cost = [&](double log_factor) {
      const Extrinsics rig = scaled(std::exp(log_factor));
      double sum = 0;
      for (std::size_t j = 0; j < judged_.size(); j += every) {
        sum += agree(tracks_.instants[judged_[j]], rig, noise_scale_).cost;
      }
      return sum;
    };
    double coarse_least = coarse_cost(0);
    for (double x = -kMost; x <= kMost; x += kStep) {
      const double c = coarse_cost(x);
      if (c < coarse_least) {
        coarse_least = c;
        best = x;
      }
    }
    double least = cost(best);
    double width = kStep;
    for (int i = 0; i < 24; ++i) {
      for (const double x : {best - width, best + width}) {
        const double c = cost(x);
        if (c < least) {
          least = c;
          best = x;
        }
      }
      width *= 0.6;
    }
    const double h = 1e-3;
    const double curvature = (cost(best + h) - 2 * least + cost(best - h)) / (h * h);
    const double sigma = curvature > 0 ? std::sqrt(2.0 / curvature) : 0.0;
    all.push_back(scale_hypothesis(std::exp(best), sigma));
  }

  Hypothesis scale_hypothesis(double factor, double relative_sigma) const {
    struct Unit {
      double per_metre;
      const char* name;
    };
    Hypothesis h;
    h.tracks = as_seen_;
    h.explanation.cameras = all_but_first();
    constexpr double kSameUnit = 0.04;  // sizes are right within some percent
    for (const Unit& unit :
         {Unit{1000, "mm"}, Unit{100, "cm"}, Unit{39.3701, "inches"}, Unit{3.28084, "feet"}}) {
      if (std::abs(factor * unit.per_metre - 1.0) > kSameUnit) continue;
      h.explanation.cause = Cause::rig_unit;
      h.explanation.value = 1.0 / factor;
      h.explanation.sigma = relative_sigma / factor;
      h.explanation.detail = fmt::format(
          "translations in rig.yaml are {:.4g} times as long as the cameras stand apart: in {}?",
          1.0 / factor, unit.name);
      h.explanation.remedy = "Write the translations of rig.yaml in metres.";
      evaluate(h, scaled(1.0 / unit.per_metre));
      return h;
    }
    h.listed = false;
    h.numbers = 1;
    h.explanation.cause = Cause::size_scale;
    h.explanation.value = 100.0 * (factor - 1.0);
    h.explanation.sigma = 100.0 * relative_sigma * factor;
    h.explanation.unit = "%";
    h.explanation.detail = fmt::format(
        "stated sizes are {:.1f} ± {:.1f} % too {} against the rig's baselines, or the baselines "
        "too {}",
        std::abs(h.explanation.value), std::max(0.1, h.explanation.sigma),
        factor < 1 ? "small" : "large", factor < 1 ? "large" : "small");
    h.explanation.remedy =
        "Measure the outer edge of a marker's black border and correct markers.toml; if it is as "
        "stated, measure the distance between two cameras.";
    evaluate(h, scaled(factor));
    return h;
  }

  std::vector<std::size_t> all_but_first() const {
    std::vector<std::size_t> cameras_but_first(cameras() - 1);
    std::iota(cameras_but_first.begin(), cameras_but_first.end(), std::size_t{1});
    return cameras_but_first;
  }

  /// Camera k's places moved to the frame set's stamp from `offset_s` later on the others' path.
  CameraTracks moved_in_time(const RigPath& path, int camera, double offset_s) const {
    CameraTracks tracks = tracks_;
    for (const std::size_t i : judged_) {
      auto& place = tracks.instants[i].places[static_cast<std::size_t>(camera)];
      if (!place) continue;
      const auto motion = path.motion(i, offset_s);
      if (motion) place->world_from_cam = motion->inverse() * place->world_from_cam;
    }
    return tracks;
  }

  void add_late(std::vector<Hypothesis>& all, int camera) const {
    const RigPath path(tracks_, stated_, noise_scale_, camera);
    if (!path.moves()) return;
    const auto k = static_cast<std::size_t>(camera);
    const auto cost = [&](double offset_s) {
      double sum = 0;
      for (const std::size_t i : judged_) {
        const auto& place = tracks_.instants[i].places[k];
        if (!place || !path.at(i)) continue;
        const auto motion = path.motion(i, offset_s);
        const Rigid3 rig = motion ? *motion * *path.at(i) : *path.at(i);
        sum += bounded_misfit(squared_misfit(*place, rig * stated_[k], 2.0 * noise_scale_));
      }
      return sum;
    };
    const double most = std::max(0.5, 3.0 * path.period_s());
    const double step = std::min(0.01, path.period_s() / 8.0);
    double best = 0;
    double least = cost(0);
    for (double offset = -most; offset <= most; offset += step) {
      const double c = cost(offset);
      if (c < least) {
        least = c;
        best = offset;
      }
    }
    double width = step;
    for (int i = 0; i < 24; ++i) {
      for (const double offset : {best - width, best + width}) {
        const double c = cost(offset);
        if (c < least) {
          least = c;
          best = offset;
        }
      }
      width *= 0.6;
    }
    const double h = 0.2 * step;
    const double curvature = (cost(best + h) - 2 * least + cost(best - h)) / (h * h);
    Hypothesis hypothesis;
    hypothesis.tracks = std::make_shared<const CameraTracks>(moved_in_time(path, camera, best));
    hypothesis.numbers = 1;
    hypothesis.listed = false;
    RigExplanation& e = hypothesis.explanation;
    e.cause = Cause::clock;
    e.cameras = {k};
    e.value = -milliseconds(best);
    e.sigma = curvature > 0 ? milliseconds(std::sqrt(2.0 / curvature)) : 0.0;
    e.unit = "ms";
    e.detail = fmt::format("its images are {:.1f} ± {:.1f} ms {} than their stamps say, against {}",
                           std::abs(e.value), std::max(0.1, e.sigma),
                           e.value > 0 ? "older" : "newer", names_of_others(camera));
    e.remedy =
        "Trigger the cameras together, stamp them by one clock, or state the delay where "
        "stamps are made.";
    e.leave_out = true;
    evaluate(hypothesis, stated_);
    e.rig_from_cam = stated_;
    all.push_back(std::move(hypothesis));
  }

  std::string names_of_others(int camera) const {
    std::string text;
    for (std::size_t k = 0; k < cameras(); ++k) {
      if (static_cast<int>(k) == camera) continue;
      text += (text.empty() ? "" : ", ") + names_[k];
    }
    return text;
  }

  /// Where to change from the first row of costs to the second, and what that costs in all.
  struct Change {
    std::size_t at = 0;
    double cost = 0;
  };
  static Change best_change(const std::vector<double>& before, const std::vector<double>& after) {
    double cost = std::accumulate(after.begin(), after.end(), 0.0);
    Change best{0, cost};
    for (std::size_t j = 0; j < before.size(); ++j) {
      cost += before[j] - after[j];
      if (cost < best.cost) best = {j + 1, cost};
    }
    return best;
  }

  void add_out_of_step(std::vector<Hypothesis>& all, int camera) const {
    const auto k = static_cast<std::size_t>(camera);
    const std::vector<double> before = costs_of(tracks_, stated_);
    for (const int shift : {-3, -2, -1, 1, 2, 3}) {
      CameraTracks in_step = tracks_;
      const auto count = static_cast<std::ptrdiff_t>(tracks_.instants.size());
      for (std::ptrdiff_t i = 0; i < count; ++i) {
        const std::ptrdiff_t source = i - shift;
        auto& place = in_step.instants[static_cast<std::size_t>(i)].places[k];
        place.reset();
        if (source >= 0 && source < count) {
          place = tracks_.instants[static_cast<std::size_t>(source)].places[k];
        }
      }
      const std::vector<double> after = costs_of(in_step, stated_);
      const Change change = best_change(before, after);
      if (change.at < kMinInstants || judged_.size() - change.at < kMinInstants) continue;
      Hypothesis h;
      h.since = judged_[change.at];
      h.numbers = 2;
      h.listed = false;
      for (std::size_t i = 0; i < h.since; ++i) {
        in_step.instants[i].places[k] = tracks_.instants[i].places[k];
      }
      h.tracks = std::make_shared<const CameraTracks>(std::move(in_step));
      evaluate(h, stated_);
      RigExplanation& e = h.explanation;
      e.cause = Cause::frame_order;
      e.cameras = {k};
      e.value = shift;
      e.unit = "frames";
      e.since = tracks_.instants[h.since].stamp;
      e.detail = fmt::format(
          "from frame set {} on its images show what the others saw {} frame{} {}: a lost frame?",
          e.since->count(), std::abs(shift), std::abs(shift) == 1 ? "" : "s",
          shift > 0 ? "later" : "earlier");
      e.remedy =
          "Pair images by their stamps, not by number; or leave that camera's images out from "
          "there on.";
      e.rig_from_cam = stated_;
      e.leave_out = true;
      all.push_back(std::move(h));
    }
  }

  void add_bumped(std::vector<Hypothesis>& all, int camera) const {
    const auto k = static_cast<std::size_t>(camera);
    const std::size_t third = judged_.size() / 3;
    if (third < kMinInstants) return;
    for (const bool later : {true, false}) {
      const auto place =
          later ? place_by_others(tracks_, camera, judged_.size() - third, judged_.size())
                : place_by_others(tracks_, camera, 0, third);
      if (!place) continue;
      Extrinsics sound = stated_;
      Extrinsics moved = stated_;
      moved[k] = *place;
      Change change;
      constexpr int kRounds = 3;
      for (int round = 0; round < kRounds; ++round) {
        const std::vector<double> as_file = costs_of(tracks_, sound);
        const std::vector<double> as_moved = costs_of(tracks_, moved);
        change = later ? best_change(as_file, as_moved) : best_change(as_moved, as_file);
        if (change.at < kMinInstants || judged_.size() - change.at < kMinInstants) break;
        moved = later ? fit(tracks_, moved, camera, change.at, judged_.size())
                      : fit(tracks_, moved, camera, 0, change.at);
        sound = later ? fit(tracks_, stated_, -1, 0, change.at)
                      : fit(tracks_, stated_, -1, change.at, judged_.size());
      }
      if (change.at < kMinInstants || judged_.size() - change.at < kMinInstants) continue;
      Hypothesis h;
      h.tracks = as_seen_;
      h.since = judged_[change.at];
      h.rig = later ? moved : sound;
      h.rig_before = later ? sound : moved;
      h.numbers = 7;
      h.listed = false;
      h.cost = cost_of(tracks_, h.rig_before, 0, change.at) +
               cost_of(tracks_, h.rig, change.at, judged_.size()) + prior_cost(sound, stated_, -1);
      RigExplanation& e = h.explanation;
      describe_displacement(moved[k], stated_[k], e);
      e.cause = Cause::rig_bumped;
      e.cameras = {k};
      e.since = tracks_.instants[h.since].stamp;
      const double at_s =
          std::chrono::duration<double>(*e.since - tracks_.instants.front().stamp).count();
      e.detail = fmt::format(
          "was turned by {:.1f}° and moved by {:.0f} mm at about {:.1f} s (frame set {}); {} that "
          "it fits rig.yaml",
          turn_deg(moved[k], stated_[k]),
          1e3 * (moved[k].translation - stated_[k].translation).norm(), at_s, e.since->count(),
          later ? "before" : "after");
      e.remedy = fmt::format(
          "Use the images {} that, or calibrate anew for the others; fasten the camera.",
          later ? "before" : "after");
      e.rig_from_cam = stated_;
      e.leave_out = true;
      all.push_back(std::move(h));
    }
  }

  static double turn_deg(const Rigid3& a, const Rigid3& b) {
    return degrees(angle_between_rad(a.rotation, b.rotation));
  }

  void describe_displacement(const Rigid3& fitted, const Rigid3& stated, RigExplanation& e) const {
    e.value = turn_deg(fitted, stated);
    e.unit = "°";
  }

  void add_displaced(std::vector<Hypothesis>& all, int camera) const {
    const auto k = static_cast<std::size_t>(camera);
    const auto place = place_by_others(tracks_, camera, 0, judged_.size());
    if (!place) return;
    Extrinsics start = stated_;
    start[k] = *place;
    Hypothesis h;
    h.tracks = as_seen_;
    h.numbers = 6;
    h.listed = false;
    evaluate(h, start, camera);
    RigExplanation& e = h.explanation;
    e.cause = Cause::rig_displaced;
    e.cameras = {k};
    const double distance_m = (h.rig[k].translation - stated_[k].translation).norm();
    describe_displacement(h.rig[k], stated_[k], e);
    e.detail = fmt::format("stands {:.1f} mm and {:.2f}° away from where rig.yaml has it",
                           1e3 * distance_m, e.value);
    e.remedy =
        "See whether it was moved or its entry mistyped; calibrate the rig anew, or build with "
        "--refine extrinsics.";
    all.push_back(std::move(h));
  }

  /// Several cameras stand elsewhere: each is placed by those that are sound, then all are free.
  void add_all_displaced(std::vector<Hypothesis>& all) const {
    Extrinsics start = stated_;
    for (std::size_t k = 1; k < cameras(); ++k) {
      if (const auto place = place_by_first(k)) start[k] = *place;
    }
    Hypothesis h;
    h.tracks = as_seen_;
    h.numbers = 6 * (static_cast<int>(cameras()) - 1);
    h.listed = false;
    evaluate(h, start, kAllCameras);
    RigExplanation& e = h.explanation;
    e.cause = Cause::rig_displaced;
    constexpr double kWorthNaming = 5.0;  // stated sigmas
    for (std::size_t k = 1; k < cameras(); ++k) {
      const Vector6d off = h.rig[k].minus(stated_[k]);
      if (std::sqrt(off.cwiseAbs2().dot(prior_)) < kWorthNaming) continue;
      e.cameras.push_back(k);
      e.value = std::max(e.value, turn_deg(h.rig[k], stated_[k]));
      e.detail += fmt::format("{}{:.1f} mm and {:.2f}°", e.detail.empty() ? "stand " : ", ",
                              1e3 * (h.rig[k].translation - stated_[k].translation).norm(),
                              turn_deg(h.rig[k], stated_[k]));
    }
    e.unit = "°";
    e.detail += fmt::format(" away from where rig.yaml has them against {}", names_.front());
    e.remedy =
        "See whether they were moved; calibrate the rig anew, or build with --refine extrinsics.";
    if (!e.cameras.empty()) all.push_back(std::move(h));
  }

  /// The place on the rig that most instants give a camera which the first one shares.
  std::optional<Rigid3> place_by_first(std::size_t camera) const {
    CameraTracks pair = tracks_;
    for (auto& instant : pair.instants) {
      for (std::size_t k = 1; k < cameras(); ++k) {
        if (k != camera) instant.places[k].reset();
      }
    }
    return place_by_others(pair, static_cast<int>(camera), 0, judged_.size());
  }

  // ---- verdict ---------------------------------------------------------------------------------

  std::optional<RigExplanation> verdict(std::vector<Hypothesis> all) const {
    double places = 0;
    for (const std::size_t i : judged_) {
      const auto& instant = tracks_.instants[i].places;
      places += static_cast<double>(std::count_if(instant.begin(), instant.end(),
                                                  [](const auto& p) { return p.has_value(); })) -
                1.0;
    }
    const double n = 6.0 * places;
    const double stated_cost = all.front().cost;
    for (Hypothesis& h : all) {
      h.explanation.gain =
          n * std::log(stated_cost / std::max(h.cost, 1e-9)) - h.numbers * std::log(n);
    }
    std::vector<Hypothesis*> order;
    for (std::size_t i = 1; i < all.size(); ++i) order.push_back(&all[i]);
    std::stable_sort(order.begin(), order.end(), [](const Hypothesis* a, const Hypothesis* b) {
      return a->explanation.gain > b->explanation.gain;
    });
    if (order.empty()) return std::nullopt;
    Hypothesis* best = order.front();
    if (best->explanation.gain < kMinGain || stated_cost < kMinCostRatio * best->cost) {
      return std::nullopt;
    }
    // Numbers may be fitted to whatever bends the tracks; they explain only what they leave at
    // about the places' own noise.
    constexpr double kMostNoise = 2.5;
    if (!best->listed && noise_scale_ > kMostNoise) return std::nullopt;
    // What a file is easily written wrongly like comes before numbers that happen to fit as well,
    // the first of them before others that the rig's symmetry makes equal.
    const double enough = best->explanation.gain - kMinLead;
    for (Hypothesis& h : all) {
      if (&h != &all.front() && h.listed && h.explanation.gain > enough) {
        best = &h;
        break;
      }
    }
    for (const Hypothesis* h : order) {
      if (h == best || h->explanation.gain < best->explanation.gain - kMinLead) continue;
      if (h->explanation.cause == best->explanation.cause &&
          h->explanation.cameras == best->explanation.cameras) {
        continue;
      }
      // Two numbers that fit as well as each other name nobody.
      if (!best->listed && !h->listed) return std::nullopt;
      const RigExplanation& other = h->explanation;
      best->explanation.alternative = {
          other.cause, other.cameras,
          fmt::format("{} (this or the other: the two look alike)", other.detail), other.remedy};
      break;
    }
    return best->explanation;
  }

  std::shared_ptr<const CameraTracks> as_seen_;
  const CameraTracks& tracks_;
  const std::vector<std::string>& names_;
  Extrinsics stated_;
  Vector6d prior_;                   ///< information of a stated place
  std::vector<std::size_t> judged_;  ///< instants
  double noise_scale_ = 1.0;
  double stated_cost_ = 0;  ///< of the stated rig, nothing fitted
};

}  // namespace

Status ExtrinsicSigmas::check() const {
  return RangeCheck()
      .field("position_m", position_m, {1e-5, 0.1})
      .field("rotation_rad", rotation_rad, {1e-5, 0.1})
      .status();
}

RigExplanation RigExplanation::or_else() const {
  RigExplanation other;
  other.cause = alternative.cause;
  other.cameras = alternative.cameras;
  other.detail = alternative.detail;
  other.remedy = alternative.remedy;
  return other;
}

std::optional<RigExplanation> explain_rig(const CameraTracks& tracks, const Rig& stated,
                                          const ExtrinsicSigmas& sigmas) {
  WAYMARK_CHECK(sigmas.check().has_value());
  return RigJudge(tracks, stated, sigmas).explain();
}

}  // namespace waymark
