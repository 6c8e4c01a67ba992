#include "mapbuilder/diagnosis/print_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/range.h"
#include "core/geometry/levenberg_marquardt.h"
#include "core/geometry/symmetric_factor.h"
#include "core/marker/marker_geometry.h"

namespace waymark {
namespace {

/// Of a view that can't be projected, as squared_residual has it.
constexpr double kHopelessSigmas2 = 1e8;

/// How many times as wide and as high as stated.
Eigen::Vector2d times_of(const PrintedPose& at) {
  return {at.factor * std::exp(0.5 * at.stretch), at.factor * std::exp(-0.5 * at.stretch)};
}

/// N: the pose's six, the logarithm of the size, and, of eight, the stretch.
template <int N>
NormalEquations<N> linearize(std::span<const MarkerView> views, const PrintedPose& at,
                             const ObservationLoss& loss) {
  NormalEquations<N> equations;
  const Eigen::Matrix3d rotation = at.world_from_marker.rotation.toRotationMatrix();
  const Eigen::Vector2d times = times_of(at);
  for (const MarkerView& view : views) {
    const MarkerObservation& o = *view.observation;
    const double gross_px = gross_residual_px(view.camera->model);
    const auto corners = linearize_corners(
        o, {&view.camera->model, Rigid3{}, view.world_from_cam, at.world_from_marker}, times);
    // A wrong id is no reason to give up; it counts as misfit alone.
    if (!corners || std::any_of(corners->begin(), corners->end(), [&](const auto& corner) {
          return !(corner.residual_px.norm() <= gross_px);
        })) {
      equations.cost += robust_cost(loss.loss, loss.scale_sigmas, kHopelessSigmas2);
      continue;
    }
    const auto stated = marker_corners(o.size_m);
    Eigen::Matrix<double, N, N> hessian = Eigen::Matrix<double, N, N>::Zero();
    Eigen::Matrix<double, N, 1> gradient = Eigen::Matrix<double, N, 1>::Zero();
    double s = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      const LinearizedCorner& corner = (*corners)[i];
      const Eigen::Vector3d x(times.x() * stated[i].x(), times.y() * stated[i].y(), 0);
      const Jacobian26& by_marker = corner.jacobians.d_marker;
      Eigen::Matrix<double, 2, N> j;
      j.template leftCols<6>() = by_marker;
      j.col(6) = by_marker.leftCols<3>() * (rotation * x);
      if constexpr (N == 8) {
        j.col(7) =
            by_marker.leftCols<3>() * (rotation * Eigen::Vector3d(0.5 * x.x(), -0.5 * x.y(), 0));
      }
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

template <int N>
PrintedPose moved(const PrintedPose& from, const Eigen::Matrix<double, N, 1>& step) {
  constexpr double kMostStep = 0.3;
  PrintedPose to = from;
  to.world_from_marker = from.world_from_marker.plus(step.template head<6>());
  to.factor *= std::exp(std::clamp(step[6], -kMostStep, kMostStep));
  if constexpr (N == 8) to.stretch += std::clamp(step[7], -kMostStep, kMostStep);
  return to;
}

template <int N>
std::optional<PrintFit> fit(std::span<const MarkerView> views, const PrintedPose& start,
                            const ObservationLoss& loss) {
  const auto optimum = minimize<N>(
      start, {.max_iterations = 40, .initial_damping = 1e-3, .negligible_decrease = 1e-6},
      [&](const PrintedPose& at) { return linearize<N>(views, at, loss); }, moved<N>);
  if (!optimum) return std::nullopt;
  const NormalEquations<N>& here = optimum->equations;
  // Misfit beyond noise says that the cameras stand a little wrong; sigmas grow by as much.
  const double freedoms = std::max(1.0, 8.0 * static_cast<double>(views.size()) - N);
  const double misfit = std::max(1.0, here.cost / freedoms);
  const Eigen::Matrix<double, N, 1> variance =
      misfit * SymmetricFactor<N>(here.hessian).inverse().diagonal();
  if (!(variance.template tail<N - 6>().minCoeff() > 0)) return std::nullopt;
  return PrintFit{optimum->place, std::sqrt(variance[6]), N == 8 ? std::sqrt(variance[N - 1]) : 0.0,
                  here.cost};
}

}  // namespace

std::optional<PrintFit> fit_print(std::span<const MarkerView> views, const PrintedPose& start,
                                  FreePrint free, const ObservationLoss& loss) {
  return free == FreePrint::size ? fit<7>(views, start, loss) : fit<8>(views, start, loss);
}

double misfit_sigmas2(const MarkerView& view, const PrintedPose& place) {
  const auto corners = linearize_corners(
      *view.observation,
      {&view.camera->model, Rigid3{}, view.world_from_cam, place.world_from_marker},
      times_of(place));
  if (!corners) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (const LinearizedCorner& corner : *corners) sum += corner.residual.squaredNorm();
  return sum;
}

std::vector<MarkerView> views_that_fit(std::vector<MarkerView> views, const PrintedPose& place,
                                       const MapEvidence& evidence) {
  constexpr double kLeastFitting = 0.75;
  const double least = kLeastFitting * static_cast<double>(views.size());
  std::erase_if(views, [&](const MarkerView& view) {
    return misfit_sigmas2(view, place) > evidence.gate_sigmas2();
  });
  if (static_cast<double>(views.size()) < least) views.clear();
  return views;
}

Status OddPrintOptions::check() const {
  return RangeCheck()
      .field("least_sigmas", least_sigmas, {3, 20})
      .field("least_size_deviation", least_size_deviation, {0.005, 0.2})
      .field("least_stretch", least_stretch, {0.005, 0.2})
      .field("least_views", least_views, {3, 50})
      .field("least_markers", least_markers, {3, 50})
      .status();
}

}  // namespace waymark
