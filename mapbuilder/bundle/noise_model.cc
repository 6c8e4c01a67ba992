#include "mapbuilder/bundle/noise_model.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/range.h"
#include "mapbuilder/bundle/estimate.h"
#include "mapbuilder/bundle/prepared_observations.h"

namespace waymark {
namespace {

/// Of the squared corner residuals that are no gross errors. A median would call the tails of a
/// real camera's model error outliers.
constexpr double kQuantile = 0.9;

/// In sigmas of the median: farther off is a gross error, as long as these are fewer than half.
constexpr double kGrossSigmas = 20.0;

Eigen::Matrix2d corner_covariance(const Observation& o, std::size_t corner, const NoiseModel& noise,
                                  double paper_weight) {
  const double variance = noise.model_sigma_px * noise.model_sigma_px;
  const Eigen::Matrix2d model = variance * Eigen::Matrix2d::Identity();
  switch (noise.weighting) {
    case Weighting::covariance:
      return o.covariances[corner] + model;
    case Weighting::paper:
      return model / paper_weight;
    case Weighting::none:
      break;
  }
  return model;
}

double paper_weight(const std::optional<IppeSolutions>& ippe, const NoiseModel& noise) {
  return noise.weighting == Weighting::paper && ippe ? observation_weight(*ippe, noise.paper) : 1.0;
}

}  // namespace

Status NoiseModel::check() const {
  return RangeCheck()
      .part("paper", paper.check())
      .field("model_sigma_px", model_sigma_px, {kSmallestModelSigma, kLargestModelSigma})
      .status();
}

std::array<Eigen::Matrix2d, 4> whitening_of(const Observation& o,
                                            const std::optional<IppeSolutions>& ippe,
                                            const NoiseModel& noise) {
  const double weight = paper_weight(ippe, noise);
  std::array<Eigen::Matrix2d, 4> whitening;
  for (std::size_t i = 0; i < 4; ++i) {
    whitening[i] = whitening_from_covariance(corner_covariance(o, i, noise, weight));
  }
  return whitening;
}

double estimate_model_sigma_px(const PreparedObservations& prepared, const Estimate& estimate,
                               std::span<const ObservationIndex> observations,
                               const NoiseModel& noise, double parameter_share) {
  const Observations& all = prepared.observations();
  struct CornerSample {
    Eigen::Vector2d residual;
    ObservationIndex observation;
    std::size_t corner;
    double weight;
  };
  std::vector<CornerSample> samples;
  samples.reserve(4 * observations.size());
  for (const ObservationIndex index : observations) {
    const Observation& o = all[index];
    const auto residuals =
        corner_residuals(prepared[index], estimate.calibration.camera(all, o).model,
                         cam_from_marker(all, estimate, o));
    if (!residuals) continue;
    for (std::size_t i = 0; i < 4; ++i) {
      samples.push_back({(*residuals)[i], index, i, paper_weight(prepared[index].ippe, noise)});
    }
  }
  if (samples.empty()) return noise.model_sigma_px;

  const double freedom = std::max(0.05, 1.0 - parameter_share);
  const auto squared_at = [&](const CornerSample& s, double sigma_px) {
    NoiseModel trial = noise;
    trial.model_sigma_px = sigma_px;
    const Eigen::Matrix2d covariance =
        corner_covariance(all[s.observation], s.corner, trial, s.weight);
    return (whitening_from_covariance(covariance) * s.residual).squaredNorm();
  };
  std::vector<double> squared;
  // Sigma at which the samples' `quantile` is what Gaussian noise would give: it falls as sigma
  // grows, so bisection on the logarithm.
  const auto sigma_by = [&](double quantile) {
    constexpr int kBisections = 14;  // of a range of 1000: to 0.04 %
    const double expected = -2.0 * std::log(1.0 - quantile) * freedom;
    const auto reached = [&](double sigma_px) {
      squared.resize(samples.size());
      std::transform(samples.begin(), samples.end(), squared.begin(),
                     [&](const CornerSample& s) { return squared_at(s, sigma_px); });
      const auto at = squared.begin() +
                      static_cast<std::ptrdiff_t>(quantile * static_cast<double>(squared.size()));
      std::nth_element(squared.begin(), at, squared.end());
      return *at;
    };
    double low = kSmallestModelSigma;
    double high = kLargestModelSigma;
    if (reached(low) <= expected) return low;
    if (reached(high) >= expected) return high;
    for (int i = 0; i < kBisections; ++i) {
      const double middle = std::sqrt(low * high);
      (reached(middle) > expected ? low : high) = middle;
    }
    return std::sqrt(low * high);
  };
  const double typical = sigma_by(0.5);
  std::erase_if(samples, [&](const CornerSample& s) {
    return squared_at(s, typical) > kGrossSigmas * kGrossSigmas;
  });
  return sigma_by(kQuantile);
}

}  // namespace waymark
