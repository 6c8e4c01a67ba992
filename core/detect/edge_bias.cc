#include "core/detect/edge_bias.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "core/base/median.h"

namespace waymark {
namespace {

constexpr std::size_t kFewestMarkers = 8;
/// A share of clipped pixels from which on a marker's blur and growth can't be told apart.
constexpr double kClipped = 0.1;
constexpr double kLeastCell_px = 3.0;
/// The true scatter is one to two times the formal one; no fit is surer than this.
constexpr double kFormalToTrue = 1.6;
constexpr double kLeastSigma_px = 0.003;
/// Of half the distance of both responses: no prior decides alone.
constexpr double kOpenAtLeast = 0.5;

/// Of print and blooming, in a camera as it comes: what growth says of a response.
constexpr double kUsualGrowth_px = 0.1;

double sigma_of(const MarkerFit& fit) {
  return kFormalToTrue * std::max(fit.growth_sigma, kLeastSigma_px);
}

/// A marker's inset and its sigma, its fits under both responses weighed.
struct Inset {
  double value_px = 0;
  double sigma_px = 0;
};

Inset blend(const MarkerFits& fits, double srgb_share) {
  const MarkerFit& linear = *fits.of(SensorResponse::linear);
  const MarkerFit& srgb = *fits.of(SensorResponse::srgb);
  return {(1 - srgb_share) * linear.inset_px + srgb_share * srgb.inset_px,
          (1 - srgb_share) * sigma_of(linear) + srgb_share * sigma_of(srgb)};
}

/// A value with its weight.
struct Weighed {
  double value = 0;
  double weight = 1;
};

struct RobustMean {
  double value = 0;
  double error = 0;    ///< of the mean, by the scatter
  double scatter = 0;  ///< of single values
};

/// Tukey's biweight at four median deviations.
RobustMean tukey_mean(const std::vector<Weighed>& values) {
  constexpr double kBound = 4.0;
  constexpr int kRounds = 20;
  std::vector<double> sorted;
  sorted.reserve(values.size());
  for (const Weighed& one : values) sorted.push_back(one.value);
  RobustMean mean;
  mean.value = upper_median(sorted);
  for (double& v : sorted) v = std::abs(v - mean.value);
  mean.scatter = upper_median(sorted) / kMedianOfNormal;
  const double bound = kBound * std::max(mean.scatter, 1e-9);
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < kRounds; ++i) {
    sum = 0;
    squares = 0;
    double total = 0;
    for (const Weighed& one : values) {
      const double off = one.value - mean.value;
      const double inside = std::max(0.0, 1 - off * off / (bound * bound));
      const double weight = one.weight * inside * inside;
      sum += weight;
      total += weight * one.value;
      squares += weight * weight * off * off;
    }
    mean.value = total / sum;
  }
  mean.error = std::sqrt(squares) / sum;
  return mean;
}

/// Markers that tell of the camera, under one response.
std::vector<const EdgeSample*> telling(std::span<const EdgeSample> samples) {
  std::vector<const EdgeSample*> all;
  for (const EdgeSample& sample : samples) {
    const MarkerFits& fits = sample.fits;
    if (fits.clipped_share < kClipped && fits.cell_px >= kLeastCell_px && fits.by_response[0] &&
        fits.by_response[1]) {
      all.push_back(&sample);
    }
  }
  return all;
}

/// The mean inset, the responses weighed.
RobustMean mean_inset(const std::vector<const EdgeSample*>& samples, double srgb_share) {
  std::vector<double> variances;
  for (const EdgeSample* sample : samples) {
    const double sigma = blend(sample->fits, srgb_share).sigma_px;
    variances.push_back(sigma * sigma);
  }
  std::vector<double> sorted = variances;
  const double usual = upper_median(sorted);
  std::vector<Weighed> values;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    constexpr double kCommonShare = 0.3;  // or the surest would outweigh all others
    values.push_back(
        {blend(samples[i]->fits, srgb_share).value_px, 1 / (variances[i] + kCommonShare * usual)});
  }
  return tukey_mean(values);
}

template <typename Value>
double median_of(const std::vector<const EdgeSample*>& samples, const Value& value) {
  std::vector<double> values;
  values.reserve(samples.size());
  for (const EdgeSample* sample : samples) values.push_back(value(*sample));
  return upper_median(values);
}

/// By which response the images are explained better.
std::optional<SensorResponse> by_misfit(const std::vector<const EdgeSample*>& samples) {
  std::vector<Weighed> logs;
  for (const EdgeSample* sample : samples) {
    const double linear = sample->fits.of(SensorResponse::linear)->misfit;
    const double srgb = sample->fits.of(SensorResponse::srgb)->misfit;
    if (linear > 0 && srgb > 0) logs.push_back({std::log(srgb / linear)});
  }
  if (logs.size() < kFewestMarkers) return std::nullopt;
  const RobustMean mean = tukey_mean(logs);
  constexpr double kLeast = 0.1;
  constexpr double kSure = 5.0;
  if (std::abs(mean.value) < kLeast || std::abs(mean.value) < kSure * mean.error) {
    return std::nullopt;
  }
  return mean.value > 0 ? SensorResponse::linear : SensorResponse::srgb;
}

/// Blur and growth of an image: medians of its markers.
struct BlurAndGrowth {
  double blur_px = 0;
  double growth_px = 0;
};

std::vector<BlurAndGrowth> by_image(const std::vector<const EdgeSample*>& samples,
                                    SensorResponse response) {
  std::map<std::size_t, std::pair<std::vector<double>, std::vector<double>>> images;
  for (const EdgeSample* sample : samples) {
    auto& [blurs, growths] = images[sample->image];
    blurs.push_back(sample->fits.of(response)->blur_px);
    growths.push_back(sample->fits.of(response)->growth_px);
  }
  std::vector<BlurAndGrowth> all;
  all.reserve(images.size());
  for (auto& [image, values] : images) {
    all.push_back({upper_median(values.first), upper_median(values.second)});
  }
  return all;
}

double slope_of(const std::vector<BlurAndGrowth>& images) {
  const auto n = static_cast<double>(images.size());
  double blur = 0;
  double growth = 0;
  for (const BlurAndGrowth& one : images) {
    blur += one.blur_px / n;
    growth += one.growth_px / n;
  }
  double squares = 1e-12;
  double products = 0;
  for (const BlurAndGrowth& one : images) {
    squares += (one.blur_px - blur) * (one.blur_px - blur);
    products += (one.blur_px - blur) * (one.growth_px - growth);
  }
  return products / squares;
}

/// How surely growth follows blur, in sigmas of the slope by bootstrap.
double growth_follows_blur(const std::vector<BlurAndGrowth>& images) {
  constexpr int kDraws = 200;
  std::mt19937_64 random(1);
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    std::vector<BlurAndGrowth> drawn;
    for (std::size_t k = 0; k < images.size(); ++k)
      drawn.push_back(images[random() % images.size()]);
    const double slope = slope_of(drawn);
    sum += slope;
    squares += slope * slope;
  }
  const double mean = sum / kDraws;
  const double variance = squares / kDraws - mean * mean;
  return std::abs(slope_of(images)) / std::sqrt(std::max(variance, 1e-12));
}

/// What gamma adds to an edge grows with blur, what a print adds does not.
std::optional<SensorResponse> by_blur(const std::vector<const EdgeSample*>& samples) {
  constexpr std::size_t kLeastSamples = 30;
  constexpr std::size_t kLeastImages = 5;
  constexpr double kVaried = 0.2;  // of the median blur, between the images' quartiles
  if (samples.size() < kLeastSamples) return std::nullopt;
  std::vector<BlurAndGrowth> images = by_image(samples, SensorResponse::linear);
  if (images.size() < kLeastImages) return std::nullopt;
  std::vector<double> blurs;
  blurs.reserve(images.size());
  for (const BlurAndGrowth& one : images) blurs.push_back(one.blur_px);
  std::sort(blurs.begin(), blurs.end());
  const double quartiles = blurs[blurs.size() * 3 / 4] - blurs[blurs.size() / 4];
  if (quartiles < kVaried * blurs[blurs.size() / 2]) return std::nullopt;
  const double linear = growth_follows_blur(images);
  const double srgb = growth_follows_blur(by_image(samples, SensorResponse::srgb));
  constexpr double kFollows = 4.0;
  constexpr double kDoesNot = 2.0;
  if (srgb > kFollows && linear < kDoesNot) return SensorResponse::linear;
  if (linear > kFollows && srgb < kDoesNot) return SensorResponse::srgb;
  return std::nullopt;
}

double growth_under(const std::vector<const EdgeSample*>& samples, SensorResponse response) {
  return median_of(samples, [&](const EdgeSample& s) { return s.fits.of(response)->growth_px; });
}

/// The response that the images tell; nullopt: neither.
std::optional<SensorResponse> response_of(const std::vector<const EdgeSample*>& samples) {
  constexpr double kLeastBlur_px = 0.5;   // sharper edges look alike under both
  constexpr double kMostGrowth_px = 0.2;  // more than prints and blooming have
  for (const SensorResponse response : {SensorResponse::linear, SensorResponse::srgb}) {
    const double blur =
        median_of(samples, [&](const EdgeSample& s) { return s.fits.of(response)->blur_px; });
    if (blur < kLeastBlur_px) return std::nullopt;
  }
  std::optional<SensorResponse> response = by_misfit(samples);
  if (!response) response = by_blur(samples);
  if (response && std::abs(growth_under(samples, *response)) >= kMostGrowth_px) {
    return std::nullopt;
  }
  return response;
}

/// How probable sRGB is where the images do not tell: it is what makes white grow less.
double srgb_probability(const std::vector<const EdgeSample*>& samples) {
  const auto cost = [&](SensorResponse response) {
    const double growth = growth_under(samples, response) / kUsualGrowth_px;
    return 0.5 * growth * growth;
  };
  return 1 / (1 + std::exp(cost(SensorResponse::srgb) - cost(SensorResponse::linear)));
}

/// Whether a camera can see edges so far off: sRGB moves them by 0.3 of the blur, print and
/// blooming by some tenths of a pixel.
bool is_plausible(const EdgeBias& bias, const std::vector<const EdgeSample*>& samples) {
  constexpr double kPrint_px = 0.25;
  constexpr double kOfBlur = 0.4;
  const double blur = median_of(
      samples, [](const EdgeSample& s) { return s.fits.of(SensorResponse::linear)->blur_px; });
  return std::abs(bias.inset_px) <= kPrint_px + kOfBlur * blur;
}

}  // namespace

std::optional<EdgeBias> edge_bias(std::span<const EdgeSample> samples,
                                  std::optional<SensorResponse> stated) {
  const std::vector<const EdgeSample*> markers = telling(samples);
  if (markers.size() < kFewestMarkers) return std::nullopt;
  EdgeBias bias;
  bias.response = stated ? stated : response_of(markers);
  bias.srgb_share = bias.response ? (*bias.response == SensorResponse::srgb ? 1.0 : 0.0)
                                  : srgb_probability(markers);
  bias.markers = markers.size();
  const RobustMean mean = mean_inset(markers, bias.srgb_share);
  bias.inset_px = mean.value;
  if (!is_plausible(bias, markers)) return std::nullopt;
  const double apart = mean_inset(markers, 1).value - mean_inset(markers, 0).value;
  const double open =
      bias.response
          ? 0.0
          : std::max(0.5 * std::abs(apart) * kOpenAtLeast,
                     std::abs(apart) * std::sqrt(bias.srgb_share * (1 - bias.srgb_share)));
  bias.sigma_px = std::hypot(mean.error, open, kSurestEdges_px);
  const double noise = median_of(
      markers, [&](const EdgeSample& s) { return blend(s.fits, bias.srgb_share).sigma_px; });
  bias.scatter_px = std::sqrt(std::max(0.0, mean.scatter * mean.scatter - noise * noise));
  return bias;
}

double inset_of(const MarkerFits& fits, const EdgeBias& camera) {
  constexpr double kFarthest_px = 0.5;
  constexpr double kClippedScatter_px = 0.15;
  constexpr double kLeastScatter_px = 1e-4;
  if (!fits.by_response[0] || !fits.by_response[1]) return camera.inset_px;
  const Inset own = blend(fits, camera.srgb_share);
  if (std::abs(own.value_px - camera.inset_px) > kFarthest_px) return camera.inset_px;
  const double scatter = std::hypot(std::max(camera.scatter_px, kLeastScatter_px),
                                    fits.clipped_share >= kClipped ? kClippedScatter_px : 0.0);
  const double of_mean = 1 / (scatter * scatter);
  const double of_own = 1 / (own.sigma_px * own.sigma_px);
  return (camera.inset_px * of_mean + own.value_px * of_own) / (of_mean + of_own);
}

}  // namespace waymark
