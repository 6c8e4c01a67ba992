#include "mapbuilder/bundle/ceres_adjuster.h"

#include <ceres/ceres.h>

#include <deque>
#include <memory>

namespace waymark {
namespace {

/// How a variable is stored as a Ceres parameter block.
enum class Storage {
  pose,    ///< translation, quaternion x y z w
  six,     ///< intrinsics, as the block has them
  scalar,  ///< a size factor or an edge bias
};

constexpr int kPose = 7;
constexpr int kTangent = 6;

int size_of(Storage storage) {
  switch (storage) {
    case Storage::pose:
      return kPose;
    case Storage::six:
      return 6;
    case Storage::scalar:
      break;
  }
  return 1;
}

/// How many columns of a six-column Jacobian belong to it.
int columns_of(Storage storage) { return storage == Storage::pose ? kTangent : size_of(storage); }

Rigid3 pose_from(const double* values) {
  return {Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(values + 3)),
          Eigen::Map<const Eigen::Vector3d>(values)};
}

void store_pose(const Rigid3& pose, double* values) {
  Eigen::Map<Eigen::Vector3d> translation(values);
  Eigen::Map<Eigen::Vector4d> rotation(values + 3);
  translation = pose.translation;
  rotation = pose.rotation.coeffs();
}

/// Rigid3's tangent. Cost functions give their Jacobians by the tangent, in the first six of seven
/// columns, and the Jacobian of Plus hands these through.
class PoseManifold : public ceres::Manifold {
 public:
  [[nodiscard]] int AmbientSize() const override { return kPose; }
  [[nodiscard]] int TangentSize() const override { return kTangent; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    store_pose(pose_from(x).plus(Eigen::Map<const Vector6d>(delta)), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, kPose, kTangent, Eigen::RowMajor>> matrix(jacobian);
    matrix.setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d> difference(y_minus_x);
    difference = pose_from(y).minus(pose_from(x));
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, kTangent, kPose, Eigen::RowMajor>> matrix(jacobian);
    matrix.setIdentity();
    return true;
  }
};

/// A variable: where Ceres holds it, and where it belongs.
struct Parameter {
  Storage storage = Storage::pose;
  std::array<double, kPose> values{};
};

/// The problem's variables as parameter blocks. Before each evaluation they become BundleVariables
/// again, which all cost functions read.
class Parameters : public ceres::EvaluationCallback {
 public:
  explicit Parameters(const ReducedProblem& problem)
      : problem_(problem), at_(problem.start()), blocks_(to_size(problem.layout().blocks)) {
    const ReducedLayout& layout = problem.layout();
    for (int m = 0; m < layout.markers; ++m) {
      block(m).storage = Storage::pose;
      store_pose(at_.world_from_marker[to_size(m)], block(m).values.data());
    }
    for (const CameraIndex c : at_.cameras.indices()) store_camera(c);
    for (const SizeClassIndex k : at_.size_factor.indices()) {
      if (layout.size[k] >= 0) store_scalar(at_.size_factor[k], layout.size[k]);
    }
    for (const Rigid3& pose : at_.world_from_rig) {
      rigs_.emplace_back();
      store_pose(pose, rigs_.back().values.data());
    }
  }

  void PrepareForEvaluation(bool /*jacobians*/, bool new_point) override {
    if (new_point) take();
  }

  /// The variables at the parameters' present values.
  const BundleVariables& take() {
    const ReducedLayout& layout = problem_.layout();
    for (int m = 0; m < layout.markers; ++m) {
      at_.world_from_marker[to_size(m)] = pose_from(block(m).values.data());
    }
    for (const CameraIndex c : at_.cameras.indices()) take_camera(c);
    for (const SizeClassIndex k : at_.size_factor.indices()) {
      if (layout.size[k] >= 0) at_.size_factor[k] = block(layout.size[k]).values[0];
    }
    for (std::size_t s = 0; s < rigs_.size(); ++s) {
      if (!problem_.is_constant(s)) at_.world_from_rig[s] = pose_from(rigs_[s].values.data());
    }
    return at_;
  }

  [[nodiscard]] const BundleVariables& at() const { return at_; }
  [[nodiscard]] Parameter& block(int index) { return blocks_[to_size(index)]; }
  [[nodiscard]] const Parameter& block(int index) const { return blocks_[to_size(index)]; }
  [[nodiscard]] Parameter& rig(std::size_t slot) { return rigs_[slot]; }
  [[nodiscard]] std::size_t rigs() const { return rigs_.size(); }
  [[nodiscard]] int blocks() const { return static_cast<int>(blocks_.size()); }

 private:
  static std::size_t to_size(int index) { return static_cast<std::size_t>(index); }

  void store_scalar(double value, int index) {
    block(index).storage = Storage::scalar;
    block(index).values[0] = value;
  }

  void store_camera(CameraIndex c) {
    const ReducedLayout& layout = problem_.layout();
    if (layout.extrinsics[c] >= 0) {
      block(layout.extrinsics[c]).storage = Storage::pose;
      store_pose(at_.cameras[c].rig_from_cam, block(layout.extrinsics[c]).values.data());
    }
    const IntrinsicsVector intrinsics = intrinsics_of(at_.cameras[c].model.parameters());
    for (int k = 0; k < kIntrinsicNumbers; ++k) {
      const int row = layout.row_of(c, k);
      if (row < 0) continue;
      block(row / 6).storage = Storage::six;
      block(row / 6).values[to_size(row % 6)] = intrinsics[k];
    }
    if (layout.edge_bias[c] >= 0) store_scalar(at_.edge_bias_px[c], layout.edge_bias[c]);
  }

  void take_camera(CameraIndex c) {
    const ReducedLayout& layout = problem_.layout();
    RigCamera& camera = at_.cameras[c];
    if (layout.extrinsics[c] >= 0) {
      camera.rig_from_cam = pose_from(block(layout.extrinsics[c]).values.data());
    }
    if (layout.focal[c] >= 0) {
      const CameraParameters& now = camera.model.parameters();
      IntrinsicsVector intrinsics = intrinsics_of(now);
      for (int k = 0; k < kIntrinsicNumbers; ++k) {
        const int row = layout.row_of(c, k);
        if (row >= 0) intrinsics[k] = block(row / 6).values[to_size(row % 6)];
      }
      // Out of the model's domain: the camera stays as it was, the cost tells.
      if (auto model = CameraModel::create(with_intrinsics(now, intrinsics))) {
        camera.model = *model;
      }
    }
    if (layout.edge_bias[c] >= 0) {
      at_.edge_bias_px[c] = block(layout.edge_bias[c]).values[0];
    }
  }

  const ReducedProblem& problem_;
  BundleVariables at_;
  std::vector<Parameter> blocks_;
  std::deque<Parameter> rigs_;
};

/// Writes the columns of a six-column Jacobian that belong to a parameter block, row by row.
template <typename Matrix>
void write_jacobian(const Matrix& jacobian, Storage storage, double* to) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<RowMajor> out(to, jacobian.rows(), size_of(storage));
  out.setZero();
  out.leftCols(columns_of(storage)) = jacobian.leftCols(columns_of(storage));
}

/// One observation: its eight residuals by its rig, unless that is constant, and by its blocks.
class ObservationCost : public ceres::CostFunction {
 public:
  ObservationCost(const ReducedProblem& problem, const Parameters& parameters,
                  std::size_t observation)
      : problem_(problem),
        parameters_(parameters),
        observation_(observation),
        with_rig_(!problem.is_constant(problem.frame_set_slot(observation))),
        blocks_(problem.blocks_of(observation)) {
    set_num_residuals(8);
    if (with_rig_) mutable_parameter_block_sizes()->push_back(kPose);
    for (const int block : blocks_) {
      mutable_parameter_block_sizes()->push_back(size_of(parameters.block(block).storage));
    }
  }

  bool Evaluate(const double* const* /*parameters*/, double* residuals,
                double** jacobians) const override {
    ObservationLinearization one;
    if (!problem_.linearize(parameters_.at(), observation_, one)) return false;
    Eigen::Map<Eigen::Matrix<double, 8, 1>> out(residuals);
    out = one.residual;
    if (jacobians == nullptr) return true;
    std::size_t slot = 0;
    if (with_rig_) {
      if (jacobians[slot] != nullptr) write_jacobian(one.rig, Storage::pose, jacobians[slot]);
      ++slot;
    }
    for (std::size_t b = 0; b < blocks_.size(); ++b, ++slot) {
      if (jacobians[slot] == nullptr) continue;
      const Storage storage = parameters_.block(blocks_[b]).storage;
      for (std::size_t p = 0; p < one.part_count; ++p) {
        if (one.parts[p].block != blocks_[b]) continue;
        write_jacobian(one.parts[p].jacobian, storage, jacobians[slot]);
      }
    }
    return true;
  }

 private:
  const ReducedProblem& problem_;
  const Parameters& parameters_;
  std::size_t observation_;
  bool with_rig_;
  std::vector<int> blocks_;
};

/// A survey entry, a prior, a constant direction.
class FactorCost : public ceres::CostFunction {
 public:
  FactorCost(const BundleFactor& factor, const Parameters& parameters)
      : factor_(factor), parameters_(parameters), blocks_(factor.blocks()) {
    set_num_residuals(static_cast<int>(factor.linearize(parameters.at()).residual.size()));
    for (const int block : blocks_) {
      mutable_parameter_block_sizes()->push_back(size_of(parameters.block(block).storage));
    }
  }

  bool Evaluate(const double* const* /*parameters*/, double* residuals,
                double** jacobians) const override {
    const FactorLinearization one = factor_.linearize(parameters_.at());
    Eigen::Map<Eigen::VectorXd>(residuals, one.residual.size()) = one.residual;
    for (std::size_t b = 0; jacobians != nullptr && b < blocks_.size(); ++b) {
      if (jacobians[b] == nullptr) continue;
      Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(one.residual.size(), kTangent);
      for (const FactorLinearization::Part& part : one.parts) {
        if (part.block == blocks_[b]) sum += part.jacobian;
      }
      write_jacobian(sum, parameters_.block(blocks_[b]).storage, jacobians[b]);
    }
    return true;
  }

 private:
  const BundleFactor& factor_;
  const Parameters& parameters_;
  std::vector<int> blocks_;
};

std::unique_ptr<ceres::LossFunction> loss_function(const ObservationLoss& loss) {
  switch (loss.loss) {
    case Loss::huber:
      return std::make_unique<ceres::HuberLoss>(loss.scale_sigmas);
    case Loss::tukey:
      return std::make_unique<ceres::TukeyLoss>(loss.scale_sigmas);
    case Loss::squared:
      break;
  }
  return nullptr;
}

ceres::Problem::Options problem_options(Parameters& parameters) {
  ceres::Problem::Options options;
  options.evaluation_callback = &parameters;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  return options;
}

ceres::Solver::Options solver_options(const BundleOptions& options, Parameters& parameters,
                                      const ReducedProblem& problem) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_SCHUR;
  solver.logging_type = ceres::SILENT;
  solver.num_threads = options.threads;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  // The cost alone decides, as in the own solver.
  solver.gradient_tolerance = 1e-14;
  solver.parameter_tolerance = 1e-14;
  solver.initial_trust_region_radius = 1.0 / options.initial_damping;
  solver.max_trust_region_radius = 1e16;
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t s = 0; s < parameters.rigs(); ++s) {
    if (problem.is_constant(s)) continue;
    solver.linear_solver_ordering->AddElementToGroup(parameters.rig(s).values.data(), 0);
  }
  for (int b = 0; b < parameters.blocks(); ++b) {
    solver.linear_solver_ordering->AddElementToGroup(parameters.block(b).values.data(), 1);
  }
  return solver;
}

}  // namespace

BundleVariables minimize_with_ceres(const ReducedProblem& problem, const ObservationLoss& loss,
                                    const BundleOptions& options, BundleSummary& summary) {
  Parameters parameters(problem);
  PoseManifold manifold;
  const auto robust = loss_function(loss);
  ceres::Problem ceres_problem(problem_options(parameters));
  const auto add = [&](Parameter& parameter) {
    ceres_problem.AddParameterBlock(parameter.values.data(), size_of(parameter.storage),
                                    parameter.storage == Storage::pose ? &manifold : nullptr);
  };
  for (int b = 0; b < parameters.blocks(); ++b) add(parameters.block(b));
  for (std::size_t s = 0; s < parameters.rigs(); ++s) {
    if (!problem.is_constant(s)) add(parameters.rig(s));
  }
  for (std::size_t i = 0; i < problem.observation_count(); ++i) {
    std::vector<double*> blocks;
    const std::size_t slot = problem.frame_set_slot(i);
    if (!problem.is_constant(slot)) blocks.push_back(parameters.rig(slot).values.data());
    for (const int b : problem.blocks_of(i)) blocks.push_back(parameters.block(b).values.data());
    if (blocks.empty()) continue;
    ceres_problem.AddResidualBlock(new ObservationCost(problem, parameters, i), robust.get(),
                                   blocks);
  }
  for (const auto& factor : problem.factors()) {
    std::vector<double*> blocks;
    for (const int b : factor->blocks()) blocks.push_back(parameters.block(b).values.data());
    ceres_problem.AddResidualBlock(new FactorCost(*factor, parameters), nullptr, blocks);
  }
  ceres::Solver::Summary ended;
  ceres::Solve(solver_options(options, parameters, problem), &ceres_problem, &ended);
  summary.termination = ended.termination_type == ceres::CONVERGENCE
                            ? BundleTermination::converged
                            : BundleTermination::no_convergence;
  summary.iterations = static_cast<int>(ended.iterations.size());
  summary.initial_cost = ended.initial_cost;
  summary.final_cost = ended.final_cost;
  return ended.IsSolutionUsable() ? parameters.take() : problem.start();
}

}  // namespace waymark
