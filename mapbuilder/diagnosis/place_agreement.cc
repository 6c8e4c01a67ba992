#include "mapbuilder/diagnosis/place_agreement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "core/base/median.h"
#include "core/geometry/alignment.h"
#include "core/geometry/symmetric_factor.h"
#include "core/marker/marker_geometry.h"

namespace waymark {
namespace {

/// Welsch's bound, and how far a place may be off that agrees, in sigmas.
constexpr double kBound = 36.0;
constexpr double kAgrees = 5.0;
/// 2 Δ ln L that a fault must gain on none.
constexpr double kMinLead = 10.0;
/// Of the places' extent: what scatters by more agrees on nothing, whatever its sigmas.
constexpr double kMostScatter = 0.03;
/// Of a marker's size: no spot of it lies farther from another.
constexpr double kFarthestSpot = 1.5;
/// Triples that are tried; of more, so many drawn with a fixed seed.
constexpr std::size_t kMaxTriples = 400;

Eigen::Vector3d mirrored(const Eigen::Vector3d& x) { return {x.x(), x.y(), -x.z()}; }

bool scales(CommonFault fault) {
  return fault == CommonFault::scaled || fault == CommonFault::mirrored_and_scaled;
}

class Agreer {
 public:
  Agreer(std::span<const MeasuredPlace> places, double scale_sigma)
      : places_(places), scale_sigma_(scale_sigma), majority_(places.size() / 2 + 1) {
    draw_triples();
  }

  std::optional<PlaceAgreement> agree() {
    std::vector<PlaceAgreement> all;
    for (const CommonFault fault : {CommonFault::none, CommonFault::mirrored, CommonFault::scaled,
                                    CommonFault::mirrored_and_scaled}) {
      if (auto start = start_of(fault, Eigen::Vector3d::Zero())) all.push_back(*start);
    }
    for (const Eigen::Vector3d& shift : shifts()) {
      if (auto start = start_of(CommonFault::shifted, shift)) all.push_back(*start);
    }
    if (all.empty()) return std::nullopt;
    noise_scale_ = std::numeric_limits<double>::infinity();
    for (const PlaceAgreement& one : all) {
      noise_scale_ = std::min(noise_scale_, std::sqrt(majority_quantile(one) / kMedianOfChi2_3));
    }
    noise_scale_ = std::max(1.0, noise_scale_);
    double cost_of_none = kBound * static_cast<double>(places_.size());
    const PlaceAgreement* best = nullptr;
    for (PlaceAgreement& one : all) {
      refine(one);
      if (one.shift.norm() > kFarthestSpot) continue;
      const double cost = cost_of(one) + price_of(one.fault);
      if (one.fault == CommonFault::none) cost_of_none = cost;
      one.gain = cost_of_none - cost;
      // In the order of simplicity: what comes later must be clearly better.
      const double lead = best == nullptr || best->fault == one.fault ? 0.0 : kMinLead;
      if (best == nullptr || one.gain > best->gain + lead) best = &one;
    }
    return best == nullptr ? std::nullopt : judged(*best);
  }

 private:
  void draw_triples() {
    const std::size_t n = places_.size();
    if (n < 3) return;
    if (n * (n - 1) * (n - 2) / 6 <= kMaxTriples) {
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 1; j < n; ++j) {
          for (std::size_t k = j + 1; k < n; ++k) triples_.push_back({i, j, k});
        }
      }
      return;
    }
    std::mt19937 random(1);
    while (triples_.size() < kMaxTriples) {
      const std::array<std::size_t, 3> triple{random() % n, random() % n, random() % n};
      if (triple[0] != triple[1] && triple[1] != triple[2] && triple[0] != triple[2]) {
        triples_.push_back(triple);
      }
    }
  }

  /// Other spots that people measure than the first one's, in marker sizes: corners and centre.
  std::vector<Eigen::Vector3d> shifts() const {
    constexpr double kAnother = 0.1;
    std::vector<Eigen::Vector3d> spots{Eigen::Vector3d::Zero()};
    for (const Eigen::Vector3d& corner : marker_corners(1.0)) spots.push_back(corner);
    std::vector<Eigen::Vector3d> shifts;
    for (const Eigen::Vector3d& spot : spots) {
      const Eigen::Vector3d shift = spot - places_[0].x_in_marker / places_[0].size_m;
      if (shift.norm() > kAnother) shifts.push_back(shift);
    }
    return shifts;
  }

  double variance(const PlaceAgreement& by, std::size_t i) const {
    const double images = by.scale * places_[i].images_sigma_m;
    // Lengths in another unit have their sigmas stated in metres, most likely.
    const double measured = std::max(1.0, by.scale) * places_[i].sigma;
    return measured * measured + images * images;
  }

  /// The place as the images have it before motion and scale.
  static Eigen::Vector3d source(const PlaceAgreement& by, const MeasuredPlace& place) {
    const Eigen::Vector3d x =
        place.world_from_marker * (place.x_in_marker + place.size_m * by.shift);
    return by.mirrors() ? mirrored(x) : x;
  }

  double squared_sigmas(const PlaceAgreement& by, std::size_t i) const {
    return (places_[i].measured - by.predicted(places_[i])).squaredNorm() / variance(by, i);
  }

  double majority_quantile(const PlaceAgreement& by) const {
    std::vector<double> squared;
    for (std::size_t i = 0; i < places_.size(); ++i) squared.push_back(squared_sigmas(by, i));
    const auto at = squared.begin() + static_cast<std::ptrdiff_t>(majority_ - 1);
    std::nth_element(squared.begin(), at, squared.end());
    return *at;
  }

  std::optional<PlaceAgreement> start_of(CommonFault fault, const Eigen::Vector3d& shift) const {
    std::optional<PlaceAgreement> best;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& triple : triples_) {
      PlaceAgreement start;
      start.fault = fault;
      start.shift = shift;
      std::vector<Eigen::Vector3d> from;
      std::vector<Eigen::Vector3d> to;
      for (const std::size_t i : triple) {
        from.push_back(source(start, places_[i]));
        to.push_back(places_[i].measured);
      }
      const auto aligned = align_points(from, to, scales(fault));
      if (!aligned || !(aligned->scale > 0)) continue;
      start.scale = aligned->scale;
      start.measured_from_world = aligned->motion;
      const double quantile = majority_quantile(start);
      if (quantile < least) {
        least = quantile;
        best = start;
      }
    }
    return best;
  }

  /// Iteratively reweighted least squares; a common shift in turn with the motion.
  void refine(PlaceAgreement& by) const {
    constexpr int kRounds = 20;
    for (int round = 0; round < kRounds; ++round) {
      Eigen::Matrix<double, 7, 7> hessian = Eigen::Matrix<double, 7, 7>::Zero();
      Eigen::Matrix<double, 7, 1> gradient = Eigen::Matrix<double, 7, 1>::Zero();
      Eigen::Vector3d shift = Eigen::Vector3d::Zero();
      double shift_information = 0;
      for (std::size_t i = 0; i < places_.size(); ++i) {
        const double noise2 = noise_scale_ * noise_scale_;
        const double weight =
            std::exp(-squared_sigmas(by, i) / (kBound * noise2)) / (variance(by, i) * noise2);
        const Eigen::Vector3d lever =
            by.measured_from_world.rotation * (by.scale * source(by, places_[i]));
        const Eigen::Vector3d misfit =
            places_[i].measured - lever - by.measured_from_world.translation;
        Eigen::Matrix<double, 3, 7> jacobian;
        jacobian << Eigen::Matrix3d::Identity(), -skew(lever), lever;
        hessian += weight * jacobian.transpose() * jacobian;
        gradient += weight * jacobian.transpose() * misfit;
        shift += weight * places_[i].size_m *
                 (places_[i].world_from_marker.rotation.conjugate() *
                  (by.measured_from_world.rotation.conjugate() * misfit));
        shift_information += weight * places_[i].size_m * places_[i].size_m;
      }
      if (!scales(by.fault)) {
        const double information = 1.0 / (scale_sigma_ * scale_sigma_);
        hessian(6, 6) += information;
        gradient[6] -= information * std::log(by.scale);
      }
      const Eigen::Matrix<double, 7, 1> delta = SymmetricFactor<7>(hessian).solve(gradient);
      if (!delta.allFinite()) return;
      by.measured_from_world = by.measured_from_world.plus(delta.head<6>());
      by.scale *= std::exp(std::clamp(delta[6], -0.5, 0.5));
      by.scale_sigma = std::sqrt(SymmetricFactor<7>(hessian).inverse()(6, 6));
      if (by.fault == CommonFault::shifted && shift_information > 0) {
        by.shift += shift / shift_information;
      }
    }
  }

  double cost_of(const PlaceAgreement& by) const {
    const double noise2 = noise_scale_ * noise_scale_;
    double cost = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      cost -= kBound * std::expm1(-squared_sigmas(by, i) / (kBound * noise2));
    }
    if (!scales(by.fault)) {
      const double off = std::log(by.scale) / scale_sigma_;
      cost += off * off;
    }
    return cost;
  }

  double price_of(CommonFault fault) const {
    const double each = std::log(3.0 * static_cast<double>(places_.size()));
    return fault == CommonFault::shifted ? 2 * each : scales(fault) ? each : 0.0;
  }

  std::optional<PlaceAgreement> judged(PlaceAgreement by) const {
    by.noise_scale = noise_scale_;
    std::vector<std::size_t> odd;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      by.off.push_back((places_[i].measured - by.predicted(places_[i])).norm());
      by.agrees.push_back(within(by, i, places_[i].measured) ? 1 : 0);
      if (by.agrees.back() == 0) odd.push_back(i);
    }
    if (by.agreeing() < std::max<std::size_t>(3, majority_)) return std::nullopt;
    if (scatter_of_agreeing(by) > kMostScatter * extent()) return std::nullopt;
    for (std::size_t a = 0; a < odd.size(); ++a) {
      for (std::size_t b = a + 1; b < odd.size(); ++b) {
        const std::size_t i = odd[a];
        const std::size_t j = odd[b];
        if (within(by, i, places_[j].measured) && within(by, j, places_[i].measured)) {
          by.exchanged.emplace_back(i, j);
        }
      }
    }
    return by;
  }

  /// Root mean square, in the measured unit.
  double scatter_of_agreeing(const PlaceAgreement& by) const {
    double sum = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (by.agrees[i] != 0) sum += by.off[i] * by.off[i];
    }
    return std::sqrt(sum / static_cast<double>(by.agreeing()));
  }

  double extent() const {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const MeasuredPlace& place : places_) mean += place.measured;
    mean /= static_cast<double>(places_.size());
    double sum = 0;
    for (const MeasuredPlace& place : places_) sum += (place.measured - mean).squaredNorm();
    return std::sqrt(sum / static_cast<double>(places_.size()));
  }

  bool within(const PlaceAgreement& by, std::size_t i, const Eigen::Vector3d& measured) const {
    const double off = (measured - by.predicted(places_[i])).norm();
    return off <= kAgrees * noise_scale_ * std::sqrt(variance(by, i));
  }

  std::span<const MeasuredPlace> places_;
  double scale_sigma_;
  std::size_t majority_;
  std::vector<std::array<std::size_t, 3>> triples_;
  double noise_scale_ = 1;
};

}  // namespace

Eigen::Vector3d PlaceAgreement::predicted(const MeasuredPlace& place) const {
  const Eigen::Vector3d x = place.world_from_marker * (place.x_in_marker + place.size_m * shift);
  return measured_from_world * (scale * (mirrors() ? mirrored(x) : x));
}

Eigen::Vector3d PlaceAgreement::turned(const Eigen::Vector3d& direction) const {
  return measured_from_world.rotation * (mirrors() ? mirrored(direction) : direction);
}

std::size_t PlaceAgreement::agreeing() const {
  return static_cast<std::size_t>(std::count(agrees.begin(), agrees.end(), 1));
}

std::optional<PlaceAgreement> agreement_of(std::span<const MeasuredPlace> places,
                                           double scale_sigma) {
  if (places.size() < 3) return std::nullopt;
  return Agreer(places, scale_sigma).agree();
}

}  // namespace waymark
