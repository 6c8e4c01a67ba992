#include "mapbuilder/diagnosis/size_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/median.h"
#include "core/base/parallel.h"
#include "core/base/range.h"
#include "core/estimate/corner_residual.h"
#include "core/geometry/symmetric_factor.h"
#include "core/marker/marker_geometry.h"
#include "mapbuilder/diagnosis/view_placement.h"

namespace waymark {
namespace {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// Of a view that can't be projected, as squared_residual has it.
constexpr double kHopelessSigmas2 = 1e8;

struct SizeEquations {
  Matrix7d hessian = Matrix7d::Zero();
  Vector7d gradient = Vector7d::Zero();
  double cost = 0;
  std::size_t views = 0;  ///< that say which way to go
};

SizeEquations linearize(std::span<const MarkerView> views, const Rigid3& world_from_marker,
                        double factor, const ObservationLoss& loss) {
  SizeEquations equations;
  const Eigen::Matrix3d rotation = world_from_marker.rotation.toRotationMatrix();
  for (const MarkerView& view : views) {
    const MarkerObservation& o = *view.observation;
    const CornerChain chain(view.camera->model, Rigid3{}, view.world_from_cam, world_from_marker);
    const auto corners = marker_corners(o.size_m * factor);
    Matrix7d hessian = Matrix7d::Zero();
    Vector7d gradient = Vector7d::Zero();
    double s = 0;
    bool tells = true;
    for (std::size_t i = 0; i < 4 && tells; ++i) {
      CornerJacobians jacobians;
      const auto residual = corner_residual(chain, corners[i], o.corners_px[i], &jacobians);
      tells = residual && residual->norm() <= gross_residual_px(view.camera->model);
      if (!tells) continue;
      Eigen::Matrix<double, 2, 7> j;
      j << jacobians.d_marker, jacobians.d_marker.leftCols<3>() * (rotation * corners[i]);
      j = (o.whitening[i] * j).eval();
      const Eigen::Vector2d whitened = o.whitening[i] * *residual;
      hessian.noalias() += j.transpose() * j;
      gradient.noalias() += j.transpose() * whitened;
      s += whitened.squaredNorm();
    }
    // A wrong id is no reason to give up; it counts as misfit alone.
    if (!tells) {
      equations.cost += robust_cost(loss.loss, loss.scale_sigmas, kHopelessSigmas2);
      continue;
    }
    const double weight = robust_weight(loss.loss, loss.scale_sigmas, s);
    equations.hessian += weight * hessian;
    equations.gradient += weight * gradient;
    equations.cost += robust_cost(loss.loss, loss.scale_sigmas, s);
    ++equations.views;
  }
  return equations;
}

/// At most so many views, evenly spread.
std::vector<MarkerView> thinned(std::vector<MarkerView> views, std::size_t most) {
  if (views.size() <= most) return views;
  std::vector<MarkerView> kept;
  for (std::size_t i = 0; i < most; ++i) kept.push_back(views[i * views.size() / most]);
  return kept;
}

struct Deviation {
  MarkerIndex marker;
  double log_factor = 0;
  double sigma = 0;
};

/// What the sizes of the whole map show: centre and robust spread of their logarithms.
struct SizeScatter {
  double centre = 0;
  double spread = 0;
};

SizeScatter scatter_of(const std::vector<Deviation>& deviations) {
  std::vector<double> values;
  for (const Deviation& d : deviations) values.push_back(d.log_factor);
  SizeScatter scatter;
  scatter.centre = median(values);
  for (double& value : values) value = std::abs(value - scatter.centre);
  constexpr double kSigmaPerMedianDeviation = 1.4826;
  scatter.spread = kSigmaPerMedianDeviation * median(values);
  return scatter;
}

/// Logarithm of a fitted size over the stated one.
double deviation_of(const MapEvidence& evidence, MarkerIndex marker, const SizeFit& fit) {
  return std::log(fit.factor * evidence.size_m(marker) / evidence.stated_size_m(marker));
}

/// The best fit over starts that are far too small to far too large.
std::optional<SizeFit> fit_from_afar(std::span<const MarkerView> views,
                                     const MapEvidence& evidence) {
  constexpr std::array<double, 5> kFactors{1.0, 0.85, 1.18, 0.7, 1.4};
  std::optional<SizeFit> best;
  for (const double factor : kFactors) {
    const auto placed = place_at_size(views, factor, evidence.options());
    if (!placed) continue;
    const auto fit = fit_size(views, placed->best.pose, factor, evidence.options().loss);
    if (fit && (!best || fit->cost < best->cost)) best = fit;
  }
  return best;
}

}  // namespace

Status SizeOptions::check() const {
  return RangeCheck()
      .field("least_sigmas", least_sigmas, {3, 20})
      .field("least_deviation", least_deviation, {0.005, 0.2})
      .field("least_views", least_views, {3, 50})
      .field("least_markers", least_markers, {3, 50})
      .status();
}

std::optional<SizeFit> fit_size(std::span<const MarkerView> views, const Rigid3& world_from_marker,
                                double factor, const ObservationLoss& loss) {
  constexpr int kMostIterations = 40;
  constexpr double kNegligibleDecrease = 1e-6;  // sigmas²
  SizeFit fit{world_from_marker, factor, 0.0, 0.0};
  SizeEquations here = linearize(views, world_from_marker, factor, loss);
  if (here.views == 0) return std::nullopt;
  double damping = 1e-3;
  for (int i = 0; i < kMostIterations; ++i) {
    Matrix7d damped = here.hessian;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-12;
    const Vector7d step = -SymmetricFactor<7>(damped).solve(here.gradient);
    if (!step.allFinite()) return std::nullopt;
    const double promised = -step.dot(here.gradient);
    const Rigid3 pose = fit.world_from_marker.plus(step.head<6>());
    const double next_factor = fit.factor * std::exp(std::clamp(step[6], -0.3, 0.3));
    const SizeEquations there = linearize(views, pose, next_factor, loss);
    if (there.views > 0 && there.cost <= here.cost) {
      fit.world_from_marker = pose;
      fit.factor = next_factor;
      here = there;
      damping = std::max(1e-9, 0.2 * damping);
    } else {
      damping *= 8.0;
    }
    if (promised < kNegligibleDecrease || damping > 1e12) break;
  }
  fit.cost = here.cost;
  // Misfit beyond noise says that the cameras stand a little wrong; sigma grows by as much.
  const double freedoms = std::max(1.0, 8.0 * static_cast<double>(views.size()) - 7.0);
  const double variance = SymmetricFactor<7>(here.hessian).inverse()(6, 6);
  if (!(variance > 0)) return std::nullopt;
  fit.sigma = std::sqrt(variance * std::max(1.0, here.cost / freedoms));
  return fit;
}

std::vector<WrongSize> find_wrong_sizes(const MapEvidence& evidence, const SizeOptions& options) {
  constexpr std::size_t kScreeningViews = 32;
  constexpr std::size_t kFitViews = 64;
  const auto least_views = static_cast<std::size_t>(options.least_views);
  const std::vector<MarkerIndex>& markers = evidence.markers();
  std::vector<std::optional<Deviation>> found(markers.size());
  parallel_for(markers.size(), evidence.options().threads, [&](std::size_t m) {
    const MarkerIndex marker = markers[m];
    auto views = thinned(evidence.views_of(marker, 2), kScreeningViews);
    if (views.size() < least_views) return;
    std::optional<SizeFit> fit;
    if (const auto& place = evidence.place(marker)) {
      fit = fit_size(views, place->world_from_marker, 1.0, evidence.options().loss);
    } else {
      fit = fit_from_afar(views, evidence);
    }
    if (fit) found[m] = Deviation{marker, deviation_of(evidence, marker, *fit), fit->sigma};
  });
  std::vector<Deviation> deviations;
  for (const auto& deviation : found) {
    if (deviation) deviations.push_back(*deviation);
  }
  std::vector<WrongSize> wrong;
  if (deviations.size() < static_cast<std::size_t>(options.least_markers) + 1) return wrong;
  const SizeScatter scatter = scatter_of(deviations);
  const auto stands_out = [&](double log_factor, double sigma, double share) {
    const double off = std::abs(log_factor - scatter.centre);
    return off > share * options.least_deviation &&
           off > share * options.least_sigmas * std::hypot(scatter.spread, sigma);
  };
  for (const Deviation& suspect : deviations) {
    constexpr double kWorthAnotherLook = 0.5;
    if (!stands_out(suspect.log_factor, suspect.sigma, kWorthAnotherLook)) continue;
    const auto views = thinned(evidence.independent_views_of(suspect.marker, 2), kFitViews);
    if (views.size() < least_views) continue;
    auto fit = fit_from_afar(views, evidence);
    if (!fit) continue;
    // A marker that stands in two places can pass for one of odd size; then views contradict it.
    const double used_m = evidence.size_m(suspect.marker);
    std::vector<MarkerView> fitting = views;
    std::erase_if(fitting, [&](const MarkerView& view) {
      return misfit_sigmas2(view, {fit->world_from_marker, used_m * fit->factor}) >
             evidence.gate_sigmas2();
    });
    constexpr double kLeastFitting = 0.75;
    if (static_cast<double>(fitting.size()) < kLeastFitting * static_cast<double>(views.size())) {
      continue;
    }
    fit = fit_size(fitting, fit->world_from_marker, fit->factor, evidence.options().loss);
    if (!fit || !stands_out(deviation_of(evidence, suspect.marker, *fit), fit->sigma, 1.0))
      continue;
    const double fitted_m = used_m * fit->factor;
    wrong.push_back({suspect.marker, evidence.stated_size_m(suspect.marker), fitted_m,
                     fitted_m * std::hypot(fit->sigma, scatter.spread), scatter.spread,
                     fitting.size(), deviations.size() - 1});
  }
  return wrong;
}

}  // namespace waymark
