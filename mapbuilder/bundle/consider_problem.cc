#include "mapbuilder/bundle/consider_problem.h"

#include <algorithm>
#include <map>

#include "core/base/parallel.h"
#include "core/camera/lens_kind.h"

namespace waymark {
namespace {

/// Of the squared corners, as the noise model has it: what is farther off may be gross.
constexpr double kQuantile = 0.9;

BundleProblem all_variable(BundleProblem problem) {
  problem.scope.variable = {
      .extrinsics = true, .intrinsics = true, .sizes = true, .edge_bias = true};
  return problem;
}

/// The markers' part of a reduced system's matrix.
BlockMatrix markers_of(const BlockMatrix& all, int markers) {
  BlockMatrix own;
  for (int column = 0; column < markers; ++column) {
    own.pattern.first.push_back(static_cast<int>(own.pattern.rows.size()));
    for (int b = all.pattern.first[static_cast<std::size_t>(column)];
         b < all.pattern.first[static_cast<std::size_t>(column) + 1]; ++b) {
      const int row = all.pattern.rows[static_cast<std::size_t>(b)];
      if (row >= markers) break;
      own.pattern.rows.push_back(row);
      own.blocks.push_back(all.blocks[static_cast<std::size_t>(b)]);
    }
  }
  own.pattern.first.push_back(static_cast<int>(own.pattern.rows.size()));
  return own;
}

/// M: what stands below the markers' part, by the basis.
Eigen::MatrixXd mixed_of(const BlockMatrix& all, int markers, const Eigen::MatrixXd& basis) {
  Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(6L * markers, basis.cols());
  for (int column = 0; column < markers; ++column) {
    for (int b = all.pattern.first[static_cast<std::size_t>(column)];
         b < all.pattern.first[static_cast<std::size_t>(column) + 1]; ++b) {
      const int row = all.pattern.rows[static_cast<std::size_t>(b)];
      if (row < markers) continue;
      mixed.middleRows<6>(6L * column).noalias() +=
          all.blocks[static_cast<std::size_t>(b)].transpose() *
          basis.middleRows<6>(6L * (row - markers));
    }
  }
  return mixed;
}

/// The calibration's part, dense.
Eigen::MatrixXd calibration_of(const BlockMatrix& all, int markers) {
  const int count = all.pattern.columns() - markers;
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(6L * count, 6L * count);
  for (int column = 0; column < count; ++column) {
    const auto at = static_cast<std::size_t>(markers + column);
    for (int b = all.pattern.first[at]; b < all.pattern.first[at + 1]; ++b) {
      const int row = all.pattern.rows[static_cast<std::size_t>(b)] - markers;
      const Matrix6d& block = all.blocks[static_cast<std::size_t>(b)];
      dense.block<6, 6>(6L * row, 6L * column) = block;
      dense.block<6, 6>(6L * column, 6L * row) = block.transpose();
    }
  }
  return dense;
}

}  // namespace

ConsiderProblem::ConsiderProblem(const BundleProblem& problem, const Estimate& estimate,
                                 int threads)
    : problem_(all_variable(problem)),
      threads_(threads),
      reduced_(problem_, accepted_observations(problem_, estimate), {}, estimate, threads) {
  take_rigs(problem.prepared->observations(), estimate.calibration);
  take_parameters(problem.prepared->selection());
  make_basis(problem.scope.variable);
  take_calibration_factors();
}

void ConsiderProblem::take_rigs(const Observations& observations, const Calibration& calibration) {
  rigs_ = calibration.rigs.values();
  for (std::size_t r = 0; r < rigs_.size(); ++r) {
    Rig& rig = rigs_[r];
    drop_unfit_joint_sigmas(rig);
    const std::size_t first = observations.first_camera[RigIndex(r)].value();
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
      const auto& measured = observations.edges[CameraIndex(first + c)];
      if (measured) state_sigma(c, CameraQuantity::edge, measured->sigma_px, rig);
    }
  }
}

void ConsiderProblem::take_parameters(const Selection& selection) {
  const Observations& observations = selection.observations();
  std::map<double, double> sigma_of_size;
  for (const MarkerIndex m : observations.markers.indices()) {
    double& sigma = sigma_of_size[selection.stated_sizes_m()[m]];
    sigma = std::max(sigma, observations.size_sigmas[m]);
  }
  std::vector<StatedSize> sizes;
  for (const auto& [size_m, sigma] : sigma_of_size) sizes.push_back({size_m, sigma});
  parameters_ = consider_parameters(rigs_, sizes);
}

CameraIndex ConsiderProblem::camera_of(const ConsiderParameter& parameter) const {
  const Observations& observations = problem_.prepared->observations();
  return CameraIndex(observations.first_camera[RigIndex(parameter.rig)].value() +
                     parameter.of_rig.camera);
}

/// The calibration blocks' rows, moved by a unit of the parameter.
Eigen::VectorXd ConsiderProblem::direction_of(const ConsiderParameter& parameter) const {
  const ReducedLayout& layout = reduced_.layout();
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(6L * (layout.blocks - layout.markers));
  const auto put = [&](int block, const auto& values) {
    if (block >= 0) direction.segment(6L * (block - layout.markers), values.size()) += values;
  };
  if (parameter.is_size()) {
    for (const SizeClassIndex k : layout.size.indices()) {
      if (reduced_.stated_size_m(k) == parameter.size_m) {
        put(layout.size[k], Eigen::Matrix<double, 1, 1>::Ones());
      }
    }
    return direction;
  }
  const CameraIndex camera = camera_of(parameter);
  const RigCamera& own = reduced_.start().cameras[camera];
  const CalibrationTangent tangent = tangent_of(parameter, own.model);
  const Vector6d place = tangent.head<6>();
  if (layout.extrinsics[camera] >= 0 || parameter.of_rig.camera != 0) {
    put(layout.extrinsics[camera], place);
  } else {
    // The camera that carries its rig has no block: all others move against it instead.
    for (std::size_t c = 1; c < rigs_[parameter.rig].cameras.size(); ++c) {
      const CameraIndex other(camera.value() + c);
      const Eigen::Vector3d apart =
          reduced_.start().cameras[other].rig_from_cam.translation - own.rig_from_cam.translation;
      Vector6d against = -place;
      against.head<3>() -= place.tail<3>().cross(apart);
      put(layout.extrinsics[other], against);
    }
  }
  for (int k = 0; k < kIntrinsicNumbers; ++k) {
    const int row = layout.row_of(camera, k) - 6 * layout.markers;
    if (row >= 0) direction[row] += tangent[kIntrinsicsRow + k];
  }
  put(layout.edge_bias[camera], tangent.segment<1>(kEdgeRow));
  return direction;
}

bool ConsiderProblem::is_estimated(const ConsiderParameter& parameter,
                                   const VariableCalibration& estimated) const {
  if (parameter.is_size()) return estimated.sizes;
  const ReducedLayout& layout = reduced_.layout();
  const CameraIndex camera = camera_of(parameter);
  switch (parameter.of_rig.quantity) {
    case CameraQuantity::position:
    case CameraQuantity::rotation:
      return estimated.extrinsics && layout.extrinsics[camera] >= 0;
    case CameraQuantity::focal:
    case CameraQuantity::principal:
    case CameraQuantity::k1:
      return estimated.intrinsics && layout.focal[camera] >= 0;
    case CameraQuantity::edge:
      return estimated.edge_bias && layout.edge_bias[camera] >= 0;
    default:
      return false;
  }
}

void ConsiderProblem::make_basis(const VariableCalibration& estimated) {
  const ReducedLayout& layout = reduced_.layout();
  basis_.resize(6L * (layout.blocks - layout.markers), parameters_.count());
  for (Eigen::Index i = 0; i < parameters_.count(); ++i) {
    const ConsiderParameter& one = parameters_.all[static_cast<std::size_t>(i)];
    basis_.col(i) = direction_of(one);
    const bool moves = !basis_.col(i).isZero(0);
    estimated_.push_back(moves && is_estimated(one, estimated) ? 1 : 0);
  }
  if (estimated.intrinsics) add_extras();
}

/// What refined intrinsics have beside the parameters.
void ConsiderProblem::add_extras() {
  const ReducedLayout& layout = reduced_.layout();
  const auto add = [&](CameraIndex camera, const IntrinsicsVector& direction) {
    basis_.conservativeResize(Eigen::NoChange, basis_.cols() + 1);
    auto column = basis_.rightCols<1>();
    column.setZero();
    for (int k = 0; k < kIntrinsicNumbers; ++k) {
      if (direction[k] != 0) column[layout.row_of(camera, k) - 6 * layout.markers] = direction[k];
    }
    estimated_.push_back(1);
  };
  for (const CameraIndex c : layout.focal.indices()) {
    if (layout.focal[c] < 0) continue;
    const CameraParameters& camera = reduced_.start().cameras[c].model.parameters();
    IntrinsicsVector ratio = IntrinsicsVector::Zero();
    ratio.head<2>() << camera.fu_px, -camera.fv_px;
    add(c, ratio);
    const LensKind& lens = lens_kind(camera.distortion);
    for (int k = 0; k < lens.count() && layout.lens[c] >= 0; ++k) {
      if (k != lens.first_bend) add(c, IntrinsicsVector::Unit(4 + k));
    }
  }
}

void ConsiderProblem::take_calibration_factors() {
  const int markers = reduced_.layout().markers;
  prior_information_ = Eigen::MatrixXd::Zero(basis_.rows(), basis_.rows());
  for (const auto& factor : reduced_.factors()) {
    const std::vector<int> blocks = factor->blocks();
    if (blocks.empty() || blocks.front() < markers) continue;
    const FactorLinearization one = factor->linearize(reduced_.start());
    for (const auto& a : one.parts) {
      for (const auto& b : one.parts) {
        prior_information_.block<6, 6>(6L * (a.block - markers), 6L * (b.block - markers)) +=
            a.jacobian.transpose() * b.jacobian;
      }
    }
  }
  held_ = basis_.transpose() * prior_information_ * basis_;
}

Eigen::MatrixXd ConsiderProblem::prior() const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(columns(), columns());
  all.topLeftCorner(parameters_.count(), parameters_.count()) = parameters_.covariance;
  return all;
}

ConsiderEquations ConsiderProblem::equations(FrameSetHalf half) {
  const ReducedSystem system = reduced_.reduce(reduced_.start(), 0.0, half);
  const int markers = reduced_.layout().markers;
  ConsiderEquations made;
  made.markers.markers = reduced_.markers();
  made.markers.world_from_marker = reduced_.start().world_from_marker;
  made.markers.world_is_fixed =
      !made.markers.markers.empty() && problem_.scope.in_facility(made.markers.markers.front());
  made.markers.information = markers_of(system.information, markers);
  made.mixed = mixed_of(system.information, markers, basis_);
  made.parameters = basis_.transpose() *
                    (calibration_of(system.information, markers) - prior_information_) * basis_;
  made.gradient.resize(6L * markers + columns());
  made.gradient << system.gradient.head(6L * markers),
      basis_.transpose() * system.gradient.tail(basis_.rows());
  return made;
}

double ConsiderProblem::corner_quantile(const BundleVariables& at) const {
  std::vector<double> squared(4 * reduced_.observation_count());
  parallel_for(reduced_.observation_count(), threads_, [&](std::size_t i) {
    ObservationLinearization one;
    reduced_.linearize(at, i, one);
    for (std::size_t k = 0; k < 4; ++k) {
      squared[4 * i + k] = one.residual.segment<2>(static_cast<Eigen::Index>(2 * k)).squaredNorm();
    }
  });
  if (squared.empty()) return 0;
  const auto place = squared.begin() +
                     static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(squared.size()));
  std::nth_element(squared.begin(), place, squared.end());
  return *place;
}

double ConsiderProblem::residuals_after(const Eigen::VectorXd& markers,
                                        const Eigen::VectorXd& columns) const {
  Eigen::VectorXd step(markers.size() + basis_.rows());
  step << markers, basis_ * columns;
  double promised = 0;
  return corner_quantile(reduced_.moved(reduced_.start(), step, promised));
}

}  // namespace waymark
