#include "mapbuilder/report/residual_statistics.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "core/base/check.h"

namespace waymark {
namespace {

/// About how many bins a histogram and a radius get, and cells the longer side of an image.
constexpr double kHistogramBins = 40;
constexpr double kRadiusBins = 10;
constexpr int kGridCells = 12;

/// Sums over corners.
struct CornerSum {
  std::size_t corners = 0;
  double squared_px2 = 0;
  double radial_px = 0;
  double tangential_px = 0;
  Eigen::Vector2d residual_px = Eigen::Vector2d::Zero();

  void add(const Eigen::Vector2d& from_centre_px, const Eigen::Vector2d& residual) {
    ++corners;
    squared_px2 += residual.squaredNorm();
    residual_px += residual;
    const double radius = from_centre_px.norm();
    if (radius == 0) return;  // has no direction
    const Eigen::Vector2d outward = from_centre_px / radius;
    radial_px += residual.dot(outward);
    tangential_px += residual.dot(Eigen::Vector2d(-outward.y(), outward.x()));
  }
  [[nodiscard]] double mean(double sum) const {
    return corners == 0 ? 0.0 : sum / static_cast<double>(corners);
  }
  [[nodiscard]] double rms_px() const { return std::sqrt(mean(squared_px2)); }
  [[nodiscard]] Eigen::Vector2d mean_px() const {
    return {mean(residual_px.x()), mean(residual_px.y())};
  }
};

std::size_t bin_of(double value, double width, std::size_t count) {
  return std::min(static_cast<std::size_t>(value / width), count - 1);
}

double largest_radius_px(const ReportCamera& camera) {
  double largest = 0;
  for (const double x : {-0.5, camera.width_px - 0.5}) {
    for (const double y : {-0.5, camera.height_px - 0.5}) {
      largest = std::max(largest, (Eigen::Vector2d(x, y) - camera.principal_point_px).norm());
    }
  }
  return largest;
}

double quantile(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0;
  const auto last = static_cast<double>(sorted.size() - 1);
  return sorted[static_cast<std::size_t>(std::lround(share * last))];
}

ResidualHistogram make_histogram(const std::vector<double>& accepted_px,
                                 const std::vector<double>& rejected_px) {
  ResidualHistogram histogram;
  // The last percent would stretch the axis; what lies beyond is counted.
  const double shown_px = std::max(1e-6, 1.25 * quantile(accepted_px, 0.99));
  histogram.bin_px = round_step(shown_px / kHistogramBins);
  const auto bins = static_cast<std::size_t>(std::ceil(shown_px / histogram.bin_px));
  histogram.accepted.assign(bins, 0);
  histogram.rejected.assign(bins, 0);
  const auto count = [&](const std::vector<double>& lengths, std::vector<std::size_t>& into,
                         std::size_t& beyond) {
    for (const double length : lengths) {
      // Compared before it becomes an index: a gross one fits no integer.
      if (length >= histogram.bin_px * static_cast<double>(bins)) {
        ++beyond;
      } else {
        ++into[bin_of(length, histogram.bin_px, bins)];
      }
    }
  };
  count(accepted_px, histogram.accepted, histogram.accepted_beyond);
  count(rejected_px, histogram.rejected, histogram.rejected_beyond);
  return histogram;
}

std::vector<RadiusBin> make_radius_bins(const std::vector<CornerSum>& sums, double width_px) {
  std::vector<RadiusBin> bins;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const CornerSum& sum = sums[i];
    bins.push_back({static_cast<double>(i) * width_px, static_cast<double>(i + 1) * width_px,
                    sum.corners, sum.rms_px(), sum.mean(sum.radial_px),
                    sum.mean(sum.tangential_px)});
  }
  return bins;
}

/// What is summed up of one camera.
struct CameraSums {
  std::vector<CornerSum> radii;
  std::vector<CornerSum> cells;
  CornerSum all;
};

CameraResiduals start_camera(const ReportCamera& camera) {
  CameraResiduals residuals;
  const double cell_px = static_cast<double>(std::max(camera.width_px, camera.height_px)) /
                         static_cast<double>(kGridCells);
  residuals.columns = std::max(1, static_cast<int>(std::lround(camera.width_px / cell_px)));
  residuals.rows = std::max(1, static_cast<int>(std::lround(camera.height_px / cell_px)));
  return residuals;
}

std::size_t cell_of(const Eigen::Vector2d& pixel, const ReportCamera& camera,
                    const CameraResiduals& grid) {
  const auto along = [](double position, int length_px, int cells) {
    const double cell = (position + 0.5) / length_px * cells;
    return static_cast<std::size_t>(std::clamp(cell, 0.0, static_cast<double>(cells - 1)));
  };
  return along(pixel.y(), camera.height_px, grid.rows) * static_cast<std::size_t>(grid.columns) +
         along(pixel.x(), camera.width_px, grid.columns);
}

}  // namespace

double round_step(double value) {
  WAYMARK_CHECK(value > 0);
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= value * (1 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

ResidualStatistics residual_statistics(std::span<const ReportObservation> observations,
                                       std::span<const ReportCamera> cameras) {
  ResidualStatistics result;
  double largest_px = 0;
  for (const ReportCamera& camera : cameras) {
    result.by_camera.push_back(start_camera(camera));
    largest_px = std::max(largest_px, largest_radius_px(camera));
  }
  const double width_px = round_step(std::max(1.0, largest_px) / kRadiusBins);
  const auto radii =
      std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(largest_px / width_px)));

  CameraSums total{std::vector<CornerSum>(radii), {}, {}};
  std::vector<CameraSums> sums;
  for (const CameraResiduals& grid : result.by_camera) {
    sums.push_back({std::vector<CornerSum>(radii),
                    std::vector<CornerSum>(static_cast<std::size_t>(grid.columns * grid.rows)),
                    {}});
  }
  std::vector<double> accepted_px;
  std::vector<double> rejected_px;
  for (const ReportObservation& o : observations) {
    WAYMARK_CHECK(o.camera < cameras.size());
    CameraResiduals& camera = result.by_camera[o.camera];
    ++camera.observations;
    camera.rejected += o.accepted ? 0 : 1;
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const Eigen::Vector2d& residual = o.residuals_px[corner];
      (o.accepted ? accepted_px : rejected_px).push_back(residual.norm());
      if (!o.accepted) continue;
      const Eigen::Vector2d from_centre =
          o.corners_px[corner] - cameras[o.camera].principal_point_px;
      const std::size_t radius = bin_of(from_centre.norm(), width_px, radii);
      CameraSums& of_camera = sums[o.camera];
      for (CornerSum* sum :
           {&total.all, &total.radii[radius], &of_camera.all, &of_camera.radii[radius],
            &of_camera.cells[cell_of(o.corners_px[corner], cameras[o.camera], camera)]}) {
        sum->add(from_centre, residual);
      }
    }
  }
  std::sort(accepted_px.begin(), accepted_px.end());
  result.corners = accepted_px.size();
  result.rms_px = total.all.rms_px();
  result.median_px = quantile(accepted_px, 0.5);
  result.quantile90_px = quantile(accepted_px, 0.9);
  result.histogram = make_histogram(accepted_px, rejected_px);
  result.by_radius = make_radius_bins(total.radii, width_px);
  for (std::size_t i = 0; i < sums.size(); ++i) {
    CameraResiduals& camera = result.by_camera[i];
    camera.rms_px = sums[i].all.rms_px();
    camera.mean_px = sums[i].all.mean_px();
    camera.by_radius = make_radius_bins(sums[i].radii, width_px);
    for (const CornerSum& cell : sums[i].cells) {
      camera.cells.push_back({cell.corners, cell.mean_px()});
    }
  }
  return result;
}

}  // namespace waymark
