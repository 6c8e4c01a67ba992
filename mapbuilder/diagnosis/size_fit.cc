#include "mapbuilder/diagnosis/size_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/median.h"
#include "core/base/parallel.h"
#include "core/base/range.h"
#include "core/geometry/levenberg_marquardt.h"
#include "core/geometry/symmetric_factor.h"
#include "core/marker/marker_geometry.h"
#include "mapbuilder/diagnosis/view_placement.h"

namespace waymark {
namespace {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

/// A marker's pose, and its size over the observations' stated one.
struct SizedPose {
  Rigid3 world_from_marker;
  double factor = 1.0;
};

/// Of a view that can't be projected, as squared_residual has it.
constexpr double kHopelessSigmas2 = 1e8;

using SizeEquations = NormalEquations<7>;

SizeEquations linearize(std::span<const MarkerView> views, const SizedPose& at,
                        const ObservationLoss& loss) {
  SizeEquations equations;
  const Eigen::Matrix3d rotation = at.world_from_marker.rotation.toRotationMatrix();
  for (const MarkerView& view : views) {
    const MarkerObservation& o = *view.observation;
    const double gross_px = gross_residual_px(view.camera->model);
    const auto x_in_marker = marker_corners(o.size_m * at.factor);
    const auto corners = linearize_corners(
        o, {&view.camera->model, Rigid3{}, view.world_from_cam, at.world_from_marker}, at.factor);
    // A wrong id is no reason to give up; it counts as misfit alone.
    if (!corners || std::any_of(corners->begin(), corners->end(), [&](const auto& corner) {
          return !(corner.residual_px.norm() <= gross_px);
        })) {
      equations.cost += robust_cost(loss.loss, loss.scale_sigmas, kHopelessSigmas2);
      continue;
    }
    Matrix7d hessian = Matrix7d::Zero();
    Vector7d gradient = Vector7d::Zero();
    double s = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const LinearizedCorner& corner = (*corners)[i];
      const Jacobian26& by_marker = corner.jacobians.d_marker;
      Eigen::Matrix<double, 2, 7> j;
      j << by_marker, by_marker.leftCols<3>() * (rotation * x_in_marker[i]);
      j = (o.whitening[i] * j).eval();
      hessian.noalias() += j.transpose() * j;
      gradient.noalias() += j.transpose() * corner.residual;
      s += corner.residual.squaredNorm();
    }
    const double weight = robust_weight(loss.loss, loss.scale_sigmas, s);
    equations.hessian += weight * hessian;
    equations.gradient += weight * gradient;
    equations.cost += robust_cost(loss.loss, loss.scale_sigmas, s);
    equations.corners += 4;
  }
  return equations;
}

SizedPose moved(const SizedPose& from, const Vector7d& step) {
  return {from.world_from_marker.plus(step.head<6>()),
          from.factor * std::exp(std::clamp(step[6], -0.3, 0.3))};
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
  scatter.centre = upper_median(values);
  for (double& value : values) value = std::abs(value - scatter.centre);
  constexpr double kSigmaPerMedianDeviation = 1.4826;
  scatter.spread = kSigmaPerMedianDeviation * upper_median(values);
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
  const auto optimum = minimize<7>(
      SizedPose{world_from_marker, factor},
      {.max_iterations = 40, .initial_damping = 1e-3, .negligible_decrease = 1e-6},
      [&](const SizedPose& at) { return linearize(views, at, loss); }, moved);
  if (!optimum) return std::nullopt;
  const SizeEquations& here = optimum->equations;
  SizeFit fit{optimum->place.world_from_marker, optimum->place.factor, 0.0, here.cost};
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
