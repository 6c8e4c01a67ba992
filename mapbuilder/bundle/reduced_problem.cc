#include "mapbuilder/bundle/reduced_problem.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/base/parallel.h"
#include "core/estimate/corner_residual.h"
#include "core/geometry/symmetric_factor.h"

namespace waymark {

namespace {

/// A fixed number, so that sums have one order whatever the threads; enough to keep a few busy.
constexpr std::size_t kSlices = 8;

using Jacobian86 = ObservationLinearization::Jacobian86;

}  // namespace

void ReducedProblem::cut_into_slices() {
  const std::size_t share = observations_.size() / kSlices + 1;
  for (std::size_t s = 0; s < sets_.size(); ++s) {
    if (slices_.empty() || sets_[s].first >= slices_.size() * share) slices_.push_back(s);
  }
  slices_.push_back(sets_.size());
}

double ReducedProblem::observation_cost(const BundleVariables& at, std::size_t set_slot,
                                        const ObservationSlot& observation) const {
  const MarkerObservation& o = *observation.observation;
  const CameraIndex camera = observation.camera;
  const CornerChain chain(at.cameras[camera].model, at.cameras[camera].rig_from_cam.inverse(),
                          at.world_from_rig[set_slot], at.world_from_marker[observation.marker]);
  const auto x_in_marker = marker_corners(o.size_m * at.size_factor[observation.size_class]);
  double s = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    Eigen::Vector2d observed = o.corners_px[i];
    if (scope_.variable.edge_bias) observed -= at.edge_bias_px[camera] * observation.outward[i];
    const auto residual = corner_residual(chain, x_in_marker[i], observed, nullptr);
    if (!residual) return std::numeric_limits<double>::infinity();
    s += (o.whitening[i] * *residual).squaredNorm();
  }
  return 0.5 * robust_cost(loss_.loss, loss_.scale_sigmas, s);
}

double ReducedProblem::cost(const BundleVariables& at) const {
  std::vector<double> sums(slices_.size() - 1, 0.0);
  parallel_for(sums.size(), threads_, [&](std::size_t slice) {
    for (std::size_t s = slices_[slice]; s < slices_[slice + 1]; ++s) {
      const FrameSetSlot& set = sets_[s];
      for (std::size_t i = set.first; i < set.first + set.count; ++i) {
        sums[slice] += observation_cost(at, s, observations_[i]);
      }
    }
  });
  double total = 0;
  for (const double sum : sums) total += sum;
  for (const auto& factor : factors_) {
    total += 0.5 * factor->linearize(at).residual.squaredNorm();
  }
  return total;
}

std::size_t ReducedProblem::frame_set_slot(std::size_t observation) const {
  const auto after =
      std::upper_bound(sets_.begin(), sets_.end(), observation,
                       [](std::size_t i, const FrameSetSlot& set) { return i < set.first; });
  return static_cast<std::size_t>(after - sets_.begin()) - 1;
}

bool ReducedProblem::linearize(const BundleVariables& at, std::size_t set_slot,
                               const ObservationSlot& observation,
                               ObservationLinearization& result) const {
  const MarkerObservation& o = *observation.observation;
  const CameraIndex camera = observation.camera;
  const Rigid3& world_from_marker = at.world_from_marker[observation.marker];
  const CornerChain chain(at.cameras[camera].model, at.cameras[camera].rig_from_cam.inverse(),
                          at.world_from_rig[set_slot], world_from_marker);
  const auto x_in_marker = marker_corners(o.size_m * at.size_factor[observation.size_class]);

  result.part_count = 0;
  const auto part_for = [&](int block) -> Jacobian86* {
    if (block < 0) return nullptr;
    ObservationLinearization::Part& part = result.parts[result.part_count++];
    part.block = block;
    part.jacobian.setZero();
    return &part.jacobian;
  };
  Jacobian86* by_marker = part_for(observation.block);
  Jacobian86* by_extrinsics = part_for(layout_.extrinsics[camera]);
  Jacobian86* by_focal = part_for(layout_.focal[camera]);
  Jacobian86* by_lens = part_for(layout_.lens[camera]);
  Jacobian86* by_bias = part_for(layout_.edge_bias[camera]);
  Jacobian86* by_size = part_for(layout_.size[observation.size_class]);
  bool in_domain = true;
  const bool calibrating = by_extrinsics != nullptr || by_focal != nullptr;

  for (std::size_t i = 0; i < 4; ++i) {
    CornerJacobians jacobians;
    CalibrationJacobians calibration;
    Eigen::Vector2d observed = o.corners_px[i];
    if (by_bias != nullptr) observed -= at.edge_bias_px[camera] * observation.outward[i];
    const auto residual = corner_residual(chain, x_in_marker[i], observed, &jacobians,
                                          calibrating ? &calibration : nullptr);
    const auto row = static_cast<Eigen::Index>(2 * i);
    const Eigen::Matrix2d& w = o.whitening[i];
    if (!residual) {  // only at a start outside the domain: cost() never leads here
      result.residual.segment<2>(row).setZero();
      result.rig.middleRows<2>(row).setZero();
      in_domain = false;
      continue;
    }
    result.residual.segment<2>(row) = w * *residual;
    if (by_marker != nullptr) by_marker->middleRows<2>(row) = w * jacobians.d_marker;
    result.rig.middleRows<2>(row) = w * jacobians.d_rig;
    if (by_extrinsics != nullptr) {
      by_extrinsics->middleRows<2>(row) = w * calibration.d_extrinsics;
    }
    if (by_focal != nullptr) {
      calibration.d_intrinsics.rightCols(kMaxCoefficients - layout_.coefficients).setZero();
      by_focal->block<2, 4>(row, 0) = w * calibration.d_intrinsics.leftCols<4>();
      by_focal->block<2, 2>(row, 4) = w * calibration.d_intrinsics.rightCols<2>();
    }
    if (by_lens != nullptr) {
      by_lens->middleRows<2>(row) = w * calibration.d_intrinsics.middleCols<6>(4);
    }
    if (by_bias != nullptr) by_bias->block<2, 1>(row, 0) = -(w * observation.outward[i]);
    if (by_size != nullptr) {
      const Eigen::Vector3d per_factor = world_from_marker.rotation * marker_corners(o.size_m)[i];
      by_size->block<2, 1>(row, 0) = w * (jacobians.d_marker.leftCols<3>() * per_factor);
    }
  }
  return in_domain;
}

/// Weighs the linearization by the loss; returns its cost ½ ρ.
double ReducedProblem::apply_loss(ObservationLinearization& linearization) const {
  const double s = linearization.residual.squaredNorm();
  const double root_weight = std::sqrt(robust_weight(loss_.loss, loss_.scale_sigmas, s));
  if (root_weight != 1.0) {
    linearization.residual *= root_weight;
    linearization.rig *= root_weight;
    for (std::size_t p = 0; p < linearization.part_count; ++p) {
      linearization.parts[p].jacobian *= root_weight;
    }
  }
  return 0.5 * robust_cost(loss_.loss, loss_.scale_sigmas, s);
}

void ReducedProblem::reduce_frame_set(const BundleVariables& at, std::size_t set_slot,
                                      double damping, SliceSums& sums) {
  const FrameSetSlot& set = sets_[set_slot];
  std::vector<Matrix6d> rig_block(set.blocks.size(), Matrix6d::Zero());  // H_rb
  std::vector<Vector6d> block_gradient(set.blocks.size(), Vector6d::Zero());
  Matrix6d rig_rig = Matrix6d::Zero();
  Vector6d rig_gradient = Vector6d::Zero();
  const auto local = [&](int block) {
    return static_cast<std::size_t>(std::lower_bound(set.blocks.begin(), set.blocks.end(), block) -
                                    set.blocks.begin());
  };

  ObservationLinearization one;
  for (std::size_t i = set.first; i < set.first + set.count; ++i) {
    linearize(at, set_slot, observations_[i], one);
    sums.cost += apply_loss(one);
    if (!set.constant) {
      rig_rig.noalias() += one.rig.transpose().lazyProduct(one.rig);
      rig_gradient.noalias() += one.rig.transpose() * one.residual;
    }
    for (std::size_t a = 0; a < one.part_count; ++a) {
      const ObservationLinearization::Part& part = one.parts[a];
      const std::size_t k = local(part.block);
      block_gradient[k].noalias() += part.jacobian.transpose() * one.residual;
      if (!set.constant) {
        rig_block[k].noalias() += one.rig.transpose().lazyProduct(part.jacobian);
      }
      for (std::size_t b = 0; b < one.part_count; ++b) {
        const ObservationLinearization::Part& other = one.parts[b];
        if (other.block < part.block) continue;
        const Matrix6d direct = other.jacobian.transpose().lazyProduct(part.jacobian);
        if (a == b) sums.diagonal.segment<6>(6L * part.block) += direct.diagonal();
        sums.blocks[static_cast<std::size_t>(pattern_.find(other.block, part.block))] += direct;
      }
    }
  }
  for (std::size_t k = 0; k < set.blocks.size(); ++k) {
    sums.gradient.segment<6>(6L * set.blocks[k]) += block_gradient[k];
  }
  if (set.constant) return;

  EliminatedRig& rig = rigs_[set_slot];
  rig.gradient = rig_gradient;
  rig.damping = damping * rig_rig.diagonal();
  rig_rig.diagonal() += rig.damping;
  const SymmetricFactor<6> factor(rig_rig);
  rig.offset = factor.solve(rig_gradient);
  for (std::size_t k = 0; k < set.blocks.size(); ++k) {
    Matrix6d& back = back_substitution_[set.first_block + k];
    back = factor.solve_columns(rig_block[k]);
    sums.gradient.segment<6>(6L * set.blocks[k]).noalias() -= rig_block[k].transpose() * rig.offset;
    const int* rows = pattern_.rows.data();
    int block = pattern_.first[static_cast<std::size_t>(set.blocks[k])];
    for (std::size_t l = k; l < set.blocks.size(); ++l) {
      while (rows[block] != set.blocks[l]) ++block;
      sums.blocks[static_cast<std::size_t>(block)].noalias() -=
          rig_block[l].transpose().lazyProduct(back);
    }
  }
}

ReducedSystem ReducedProblem::reduce(const BundleVariables& at, double damping, FrameSetHalf half) {
  if (pattern_.first.empty()) {
    std::vector<std::vector<int>> groups;
    groups.reserve(sets_.size() + factors_.size());
    for (const FrameSetSlot& set : sets_) groups.push_back(set.blocks);
    for (const auto& factor : factors_) groups.push_back(factor->blocks());
    pattern_ = pattern_of_groups(layout_.blocks, groups);
  }
  std::vector<SliceSums> slices(slices_.size() - 1);
  parallel_for(slices.size(), threads_, [&](std::size_t index) {
    SliceSums& sums = slices[index];
    sums.blocks.assign(pattern_.blocks(), Matrix6d::Zero());
    sums.gradient = sums.diagonal = Eigen::VectorXd::Zero(6L * layout_.blocks);
    for (std::size_t s = slices_[index]; s < slices_[index + 1]; ++s) {
      if (counts(s, half)) reduce_frame_set(at, s, damping, sums);
    }
  });

  ReducedSystem system;
  system.information.pattern = pattern_;
  system.information.blocks = std::move(slices[0].blocks);
  system.gradient = slices[0].gradient;
  system.diagonal = slices[0].diagonal;
  system.cost = slices[0].cost;
  for (std::size_t s = 1; s < slices.size(); ++s) {
    system.gradient += slices[s].gradient;
    system.diagonal += slices[s].diagonal;
    system.cost += slices[s].cost;
  }
  constexpr std::size_t kStretch = 4096;
  parallel_for(pattern_.blocks() / kStretch + 1, threads_, [&](std::size_t stretch) {
    const std::size_t end = std::min(pattern_.blocks(), (stretch + 1) * kStretch);
    for (std::size_t s = 1; s < slices.size(); ++s) {
      for (std::size_t b = stretch * kStretch; b < end; ++b) {
        system.information.blocks[b] += slices[s].blocks[b];
      }
    }
  });

  for (const auto& factor : factors_) {
    const FactorLinearization one = factor->linearize(at);
    system.cost += 0.5 * one.residual.squaredNorm();
    for (const auto& part : one.parts) {
      system.gradient.segment<6>(6L * part.block) += part.jacobian.transpose() * one.residual;
      for (const auto& other : one.parts) {
        if (other.block < part.block) continue;
        const Matrix6d direct = other.jacobian.transpose() * part.jacobian;
        if (other.block == part.block) {
          system.diagonal.segment<6>(6L * part.block) += direct.diagonal();
        }
        const int block = pattern_.find(other.block, part.block);
        system.information.blocks[static_cast<std::size_t>(block)] += direct;
      }
    }
  }
  // Rows that nothing touches: the padding of calibration blocks.
  for (int block = 0; block < layout_.blocks; ++block) {
    Matrix6d& diagonal =
        system.information
            .blocks[static_cast<std::size_t>(pattern_.first[static_cast<std::size_t>(block)])];
    for (int r = 0; r < 6; ++r) {
      if (system.diagonal[6L * block + r] == 0.0) diagonal(r, r) = 1.0;
    }
  }
  return system;
}

std::optional<int> ReducedProblem::block_of(MarkerIndex marker) const {
  const auto slot = slot_of_[marker];
  if (!slot || static_cast<int>(*slot) >= layout_.markers) return std::nullopt;
  return static_cast<int>(*slot);
}

BundleVariables ReducedProblem::moved(const BundleVariables& from, const Eigen::VectorXd& step,
                                      double& promised) const {
  BundleVariables to = from;
  for (int m = 0; m < layout_.markers; ++m) {
    Rigid3& pose = to.world_from_marker[static_cast<std::size_t>(m)];
    pose = pose.plus(step.segment<6>(6L * m));
  }
  for (const CameraIndex c : to.cameras.indices()) {
    RigCamera& camera = to.cameras[c];
    if (layout_.extrinsics[c] >= 0) {
      camera.rig_from_cam = camera.rig_from_cam.plus(step.segment<6>(6L * layout_.extrinsics[c]));
    }
    if (layout_.focal[c] >= 0) {
      const CameraParameters& now = camera.model.parameters();
      IntrinsicsVector intrinsics = intrinsics_of(now);
      for (int k = 0; k < kIntrinsicNumbers; ++k) {
        if (const int row = layout_.row_of(c, k); row >= 0) intrinsics[k] += step[row];
      }
      // Out of the model's domain: the camera stays as it was, the cost tells.
      if (auto model = CameraModel::create(with_intrinsics(now, intrinsics))) {
        camera.model = *model;
      }
    }
    if (layout_.edge_bias[c] >= 0) to.edge_bias_px[c] += step[6L * layout_.edge_bias[c]];
  }
  for (const SizeClassIndex k : to.size_factor.indices()) {
    if (layout_.size[k] >= 0) to.size_factor[k] += step[6L * layout_.size[k]];
  }

  std::vector<double> sums(slices_.size() - 1, 0.0);
  parallel_for(sums.size(), threads_, [&](std::size_t slice) {
    for (std::size_t s = slices_[slice]; s < slices_[slice + 1]; ++s) {
      const FrameSetSlot& set = sets_[s];
      if (set.constant) continue;
      const EliminatedRig& rig = rigs_[s];
      Vector6d rig_step = -rig.offset;
      for (std::size_t k = 0; k < set.blocks.size(); ++k) {
        rig_step.noalias() -=
            back_substitution_[set.first_block + k] * step.segment<6>(6L * set.blocks[k]);
      }
      sums[slice] += 0.5 * rig_step.dot(rig.damping.cwiseProduct(rig_step) - rig.gradient);
      to.world_from_rig[s] = to.world_from_rig[s].plus(rig_step);
    }
  });
  promised = 0;
  for (const double sum : sums) promised += sum;
  return to;
}

}  // namespace waymark
