#include "mapbuilder/diagnosis/rig_file_hypotheses.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/geometry/decompositions.h"

namespace waymark {
namespace {

constexpr const char* kInvertLink =
    "Invert the transform in rig.yaml: T_cn_cnm1 takes points of camera n-1 into camera n.";
constexpr const char* kOtherWayRound = "T_cn_cnm1 is written the other way round";

/// What a driver does to images of unchanged size.
enum class Turning { none, half };

/// How the directions that a lens gives to an image's pixels turn against those of the lens that
/// took it: principal points that differ look like a turn of the camera.
Eigen::Quaterniond assumed_from_actual(const CameraModel& assumed, const CameraModel& actual,
                                       Turning turning) {
  const CameraParameters& p = assumed.parameters();
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const double u : {0.2, 0.5, 0.8}) {
    for (const double v : {0.2, 0.5, 0.8}) {
      const Eigen::Vector2d pixel(u * (p.width_px - 1), v * (p.height_px - 1));
      const Eigen::Vector2d taken =
          turning == Turning::half
              ? Eigen::Vector2d(p.width_px - 1 - pixel.x(), p.height_px - 1 - pixel.y())
              : pixel;
      const auto there = assumed.bearing(pixel);
      const auto here = actual.bearing(taken);
      if (there && here) sum += *there * here->transpose();
    }
  }
  // Kabsch's: a rotation, never a reflection.
  const SingularVectors svd = singular_vectors(sum);
  const Eigen::Vector3d signs(1, 1, (svd.u * svd.v.transpose()).determinant() < 0 ? -1 : 1);
  return Eigen::Quaterniond(Eigen::Matrix3d(svd.u * signs.asDiagonal() * svd.v.transpose()));
}

constexpr const char* kEachAtTheOthers = "each stands where rig.yaml has the other";
constexpr const char* kExchangeImages =
    "Exchange their folders or plugs, and name cameras by serial number.";

/// How far the places of two cameras may lie from where they are when each is told through the
/// other's lens: principal points that differ turn them, focal lengths move them.
struct LensBend {
  double rad = 0;
  double m = 0;
};

LensBend bend_by_exchange(const CameraModel& a, const CameraModel& b) {
  // What else bends: lenses that differ in more, and a map that is made through them.
  constexpr double kLeast_rad = 1.0 * std::numbers::pi / 180.0;
  constexpr double kLeast_m = 0.05;
  constexpr double kFarthestMarkers_m = 10.0;
  const Eigen::Quaterniond turn = assumed_from_actual(a, b, Turning::none);
  const double focal = std::abs(std::log(a.parameters().fu_px / b.parameters().fu_px));
  return {kLeast_rad + 2 * angle_between_rad(turn, Eigen::Quaterniond::Identity()),
          kLeast_m + 2 * focal * kFarthestMarkers_m};
}

/// How far the cameras stand to the first from where others have them, as a share of that.
double share_bent(const Extrinsics& places, const Extrinsics& others, const LensBend& bend) {
  double share = 0;
  for (std::size_t k = 1; k < places.size(); ++k) {
    const Rigid3 here = places[0].inverse() * places[k];
    const Rigid3 there = others[0].inverse() * others[k];
    share = std::max({share, angle_between_rad(here.rotation, there.rotation) / bend.rad,
                      (here.translation - there.translation).norm() / bend.m});
  }
  return share;
}

class FileHypotheses {
 public:
  explicit FileHypotheses(const RigCase& rig) : rig_(rig) {}

  std::vector<RigHypothesis> all() {
    add_inverted_links();
    add_inverted_body();
    add_exchanged();
    for (const int angle : {90, 180, 270}) {
      add_all_turned(angle);
      for (std::size_t k = 0; k < rig_.cameras(); ++k) add_turned(k, angle);
    }
    return std::move(all_);
  }

 private:
  void add(Cause cause, std::vector<std::size_t> concerned, const Extrinsics& places,
           std::string detail, std::string remedy, Turning turning = Turning::none) {
    RigHypothesis h = rig_.hypothesis();
    h.listed = true;
    h.explanation.cause = cause;
    h.explanation.cameras = std::move(concerned);
    h.explanation.detail = std::move(detail);
    h.explanation.remedy = std::move(remedy);
    h.explanation.turns_lenses = turning == Turning::half;
    rig_.evaluate(h, places);
    all_.push_back(std::move(h));
  }

  /// Chains of T_cn_cnm1 with the links marked written the other way round.
  [[nodiscard]] Extrinsics with_inverted_links(const std::vector<char>& inverted) const {
    Extrinsics places = rig_.stated();
    for (std::size_t n = 1; n < places.size(); ++n) {
      const Rigid3 before_from_cam = rig_.stated()[n - 1].inverse() * rig_.stated()[n];
      places[n] = places[n - 1] * (inverted[n] != 0 ? before_from_cam.inverse() : before_from_cam);
    }
    return places;
  }

  void add_inverted_links() {
    const std::vector<char> every(rig_.cameras(), 1);
    add(Cause::rig_inverted, rig_.all_but_first(), with_inverted_links(every), kOtherWayRound,
        kInvertLink);
    if (rig_.cameras() == 2) return;
    for (std::size_t n = 1; n < rig_.cameras(); ++n) {
      std::vector<char> one(rig_.cameras(), 0);
      one[n] = 1;
      add(Cause::rig_inverted, {n}, with_inverted_links(one), kOtherWayRound, kInvertLink);
    }
  }

  void add_inverted_body() {
    if (rig_.stated().front().minus(Rigid3{}).squaredNorm() < 1e-12) return;
    Extrinsics places;
    for (const Rigid3& x : rig_.stated()) places.push_back(x.inverse());
    add(Cause::rig_inverted, rig_.every_camera(), places,
        "T_cam_imu is written the other way round (T_imu_cam)",
        "Invert T_cam_imu in rig.yaml: it takes points of the body into the camera.");
  }

  void add_exchanged() {
    for (std::size_t i = 0; i < rig_.cameras(); ++i) {
      for (std::size_t j = i + 1; j < rig_.cameras(); ++j) {
        Extrinsics places = rig_.stated();
        places[i] = seen_by(j, i, Turning::none);
        places[j] = seen_by(i, j, Turning::none);
        add(Cause::rig_exchanged, {i, j}, places, kEachAtTheOthers, kExchangeImages);
        all_.back().explanation.exchanges_lenses = true;
        // In the file alone: each camera keeps its lens.
        places[i] = rig_.stated()[j];
        places[j] = rig_.stated()[i];
        add(Cause::rig_exchanged, {i, j}, places,
            "each stands where rig.yaml has the other, with the lens that rig.yaml gives it",
            "Exchange their transforms in rig.yaml.");
      }
    }
  }

  /// Where camera `actual` seems to stand while its images go through the lens of `assumed`.
  [[nodiscard]] Rigid3 seen_by(std::size_t actual, std::size_t assumed, Turning turning) const {
    const Eigen::Quaterniond off =
        assumed_from_actual(rig_.lens_of_places(assumed), rig_.stated_lens(actual), turning);
    return rig_.stated()[actual] * Rigid3{off.inverse(), Eigen::Vector3d::Zero()};
  }

  static Rigid3 turned(int angle_deg) {
    return {Eigen::Quaterniond(
                Eigen::AngleAxisd(angle_deg * std::numbers::pi / 180.0, Eigen::Vector3d::UnitZ())),
            Eigen::Vector3d::Zero()};
  }

  void add_all_turned(int angle_deg) {
    Extrinsics hung = rig_.stated();
    for (Rigid3& x : hung) x = x * turned(angle_deg);
    add_all_turned(angle_deg, hung, Turning::none);
    if (angle_deg != 180) return;
    Extrinsics turned_in_driver;
    for (std::size_t k = 0; k < rig_.cameras(); ++k) {
      turned_in_driver.push_back(seen_by(k, k, Turning::half));
    }
    add_all_turned(angle_deg, turned_in_driver, Turning::half);
  }

  void add_all_turned(int angle_deg, const Extrinsics& places, Turning turning) {
    add(angle_deg == 180 ? Cause::images_turned : Cause::rig_turned, rig_.every_camera(), places,
        fmt::format("all images are turned by {}° against rig.yaml", angle_deg),
        "See whether the driver turns images; switch that off, or correct the rotations in "
        "rig.yaml.",
        turning);
  }

  void add_turned(std::size_t camera, int angle_deg) {
    add_turned(camera, angle_deg, rig_.stated()[camera] * turned(angle_deg), Turning::none);
    if (angle_deg != 180) return;
    add_turned(camera, angle_deg, seen_by(camera, camera, Turning::half), Turning::half);
  }

  void add_turned(std::size_t camera, int angle_deg, const Rigid3& place, Turning turning) {
    Extrinsics places = rig_.stated();
    places[camera] = place;
    add(Cause::rig_turned, {camera}, places,
        fmt::format("it is turned by {}° about its optical axis against rig.yaml", angle_deg),
        "See which way up it hangs and whether its driver turns images; correct its rotation in "
        "rig.yaml.",
        turning);
  }

  const RigCase& rig_;
  std::vector<RigHypothesis> all_;
};

}  // namespace

std::vector<RigHypothesis> rig_file_hypotheses(const RigCase& rig) {
  return FileHypotheses(rig).all();
}

std::optional<RigHypothesis> exchanged_hypothesis(const RigCase& rig,
                                                  const RigHypothesis& displaced) {
  // Where the stated places are about as near, nothing tells an exchange from a displacement.
  constexpr double kNearer = 0.25;
  for (std::size_t i = 0; i < rig.cameras(); ++i) {
    for (std::size_t j = i + 1; j < rig.cameras(); ++j) {
      Extrinsics places = rig.stated();
      std::swap(places[i], places[j]);
      const LensBend bend = bend_by_exchange(rig.stated_lens(i), rig.stated_lens(j));
      const double exchanged = share_bent(displaced.rig, places, bend);
      if (exchanged > 1.0 || exchanged > kNearer * share_bent(displaced.rig, rig.stated(), bend)) {
        continue;
      }
      RigHypothesis h = displaced;
      h.listed = true;
      h.explanation.cause = Cause::rig_exchanged;
      h.explanation.cameras = {i, j};
      h.explanation.value = 0;
      h.explanation.unit.clear();
      h.explanation.detail = kEachAtTheOthers;
      h.explanation.remedy = kExchangeImages;
      h.explanation.exchanges_lenses = true;
      return h;
    }
  }
  return std::nullopt;
}

}  // namespace waymark
