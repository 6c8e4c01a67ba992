#include "mapbuilder/mapping/reduced_marker_system.h"

#include <Eigen/Dense>
#include <algorithm>
#include <map>

#include "core/base/check.h"
#include "core/estimate/corner_residual.h"
#include "core/geometry/alignment.h"
#include "mapbuilder/mapping/selected_inverse.h"

namespace waymark {
namespace {

using Block = Matrix6d;
using Pair = std::pair<int, int>;

/// One observation's part of the normal equations.
struct ObservationBlocks {
  int marker_slot = 0;
  Block marker_marker = Block::Zero();
  Block marker_rig = Block::Zero();
  Block rig_rig = Block::Zero();
};

std::optional<ObservationBlocks> linearize(const ObservationTable& table, const MapState& state,
                                           const TableObservation& o, const ObservationLoss& loss) {
  const RigCamera& camera = camera_of(table, o);
  const CornerChain chain(camera.model, camera.rig_from_cam.inverse(),
                          state.rigs[static_cast<std::size_t>(o.frame_set)]->best.pose,
                          *state.world_from_marker[static_cast<std::size_t>(o.marker)]);
  const auto x_in_marker = marker_corners(o.size_m);
  ObservationBlocks blocks;
  double s = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    CornerJacobians jacobians;
    const auto residual = corner_residual(chain, x_in_marker[i], o.corners_px[i], &jacobians);
    if (!residual) return std::nullopt;
    const Jacobian26 jm = o.whitening[i] * jacobians.d_marker;
    const Jacobian26 jr = o.whitening[i] * jacobians.d_rig;
    blocks.marker_marker.noalias() += jm.transpose() * jm;
    blocks.marker_rig.noalias() += jm.transpose() * jr;
    blocks.rig_rig.noalias() += jr.transpose() * jr;
    s += (o.whitening[i] * *residual).squaredNorm();
  }
  const double weight = robust_weight(loss.loss, loss.scale_sigmas, s);
  blocks.marker_marker *= weight;
  blocks.marker_rig *= weight;
  blocks.rig_rig *= weight;
  return blocks;
}

/// The motions of the world frame as the markers feel them, about `centre`: 6 columns (shift,
/// turn).
Eigen::MatrixXd world_motions(const std::vector<Rigid3>& markers, const Eigen::Vector3d& centre) {
  Eigen::MatrixXd n = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(6 * markers.size()), 6);
  for (std::size_t i = 0; i < markers.size(); ++i) {
    auto rows = n.middleRows<6>(static_cast<Eigen::Index>(6 * i));
    rows.topLeftCorner<3, 3>().setIdentity();
    rows.topRightCorner<3, 3>() = -skew(markers[i].translation - centre);
    rows.bottomRightCorner<3, 3>().setIdentity();
  }
  return n;
}

}  // namespace

ReducedMarkerSystem reduce_to_markers(const ObservationTable& table,
                                      std::span<const std::size_t> observations,
                                      const ObservationLoss& loss, const MapState& state) {
  std::map<int, int> slot_of_marker;
  std::map<int, std::vector<std::size_t>> by_set;
  for (const std::size_t index : observations) {
    const TableObservation& o = table.observations[index];
    if (state.accepted[index] == 0 || !state.posed(o)) continue;
    slot_of_marker.emplace(o.marker, 0);
    by_set[o.frame_set].push_back(index);
  }
  ReducedMarkerSystem system;
  for (auto& [marker, slot] : slot_of_marker) {
    slot = static_cast<int>(system.markers.size());
    system.markers.push_back(marker);
  }

  std::map<Pair, Block> blocks;  // lower half, (row slot, column slot)
  const auto add = [&](int row, int column, const Block& block) {
    const auto [entry, is_new] = blocks.try_emplace({row, column}, block);
    if (!is_new) entry->second += block;
  };
  for (const auto& [frame_set, indices] : by_set) {
    std::vector<ObservationBlocks> parts;
    Block rig_rig = Block::Zero();
    for (const std::size_t index : indices) {
      auto part = linearize(table, state, table.observations[index], loss);
      if (!part) continue;
      part->marker_slot = slot_of_marker.at(table.observations[index].marker);
      rig_rig += part->rig_rig;
      parts.push_back(*part);
    }
    const Eigen::LDLT<Block> rig_factor(rig_rig);
    for (std::size_t a = 0; a < parts.size(); ++a) {
      add(parts[a].marker_slot, parts[a].marker_slot, parts[a].marker_marker);
      const Block eliminated = rig_factor.solve(parts[a].marker_rig.transpose());
      for (std::size_t b = 0; b < parts.size(); ++b) {
        if (parts[b].marker_slot < parts[a].marker_slot) continue;
        // A marker seen by two cameras of the set meets itself: both orders belong to its diagonal.
        add(parts[b].marker_slot, parts[a].marker_slot, -(parts[b].marker_rig * eliminated));
      }
    }
  }

  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(blocks.size() * 72);
  for (const auto& [pair, block] : blocks) {
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 6; ++c) {
        entries.emplace_back(6 * pair.first + r, 6 * pair.second + c, block(r, c));
        if (pair.first != pair.second) {
          entries.emplace_back(6 * pair.second + c, 6 * pair.first + r, block(r, c));
        }
      }
    }
  }
  const auto size = static_cast<Eigen::Index>(6 * system.markers.size());
  system.information.resize(size, size);
  system.information.setFromTriplets(entries.begin(), entries.end());
  return system;
}

std::vector<Matrix6d> marker_covariances(const ReducedMarkerSystem& system, const MapState& state) {
  const auto count = static_cast<int>(system.markers.size());
  if (count < 2) return {};
  std::vector<Rigid3> poses;
  std::vector<Eigen::Vector3d> positions;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const int marker : system.markers) {
    poses.push_back(*state.world_from_marker[static_cast<std::size_t>(marker)]);
    positions.push_back(poses.back().translation);
    centre += positions.back() / count;
  }

  // S⁻ with the best-known marker fixed: the one with the largest information about its place.
  int anchor = 0;
  double best = -1;
  for (int i = 0; i < count; ++i) {
    double trace = 0;
    for (int r = 0; r < 3; ++r) trace += system.information.coeff(6 * i + r, 6 * i + r);
    if (trace > best) {
      best = trace;
      anchor = i;
    }
  }
  std::vector<Eigen::Triplet<double>> kept;
  const auto without_anchor = [&](Eigen::Index i) {
    return static_cast<int>(i < 6 * anchor ? i : i - 6);
  };
  const auto in_anchor = [&](Eigen::Index i) { return i / 6 == anchor; };
  for (Eigen::Index c = 0; c < system.information.outerSize(); ++c) {
    for (Eigen::SparseMatrix<double>::InnerIterator it(system.information, c); it; ++it) {
      if (in_anchor(it.row()) || in_anchor(it.col())) continue;
      kept.emplace_back(without_anchor(it.row()), without_anchor(it.col()), it.value());
    }
  }
  Eigen::SparseMatrix<double> reduced(6 * (count - 1), 6 * (count - 1));
  reduced.setFromTriplets(kept.begin(), kept.end());
  const auto inverse = SelectedInverse::compute(reduced);
  if (!inverse) return {};

  const Eigen::MatrixXd n = world_motions(poses, centre);
  Eigen::MatrixXd g = n;
  if (count >= 3 && !lie_on_a_line(positions)) {
    for (int i = 0; i < count; ++i) g.middleRows<3>(6 * i + 3).setZero();
  }
  const Matrix6d gauge = (g.transpose() * n).inverse();
  // S⁻ G, with zero rows for the fixed marker.
  Eigen::MatrixXd g_reduced(6 * (count - 1), 6);
  g_reduced << g.topRows(6 * anchor), g.bottomRows(6 * (count - 1 - anchor));
  const Eigen::MatrixXd solved = inverse->solve(g_reduced);
  Eigen::MatrixXd cg = Eigen::MatrixXd::Zero(6 * count, 6);
  cg.topRows(6 * anchor) = solved.topRows(6 * anchor);
  cg.bottomRows(6 * (count - 1 - anchor)) = solved.bottomRows(6 * (count - 1 - anchor));
  const Matrix6d gcg = g.transpose() * cg;

  std::vector<Matrix6d> covariances;
  for (int i = 0; i < count; ++i) {
    Matrix6d own = Matrix6d::Zero();
    if (i != anchor) {
      const int first = without_anchor(6 * i);
      for (int r = 0; r < 6; ++r) {
        for (int c = 0; c < 6; ++c) own(r, c) = (*inverse)(first + r, first + c);
      }
    }
    const Matrix6d moved = n.middleRows<6>(6 * i) * gauge;
    const Matrix6d cross = moved * cg.middleRows<6>(6 * i).transpose();
    const Matrix6d full = own - cross - cross.transpose() + moved * gcg * moved.transpose();
    // A difference of large numbers: rounding may leave an eigenvalue a little below zero.
    const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(0.5 * (full + full.transpose()));
    const Matrix6d root =
        eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
    covariances.emplace_back(root * root.transpose());
  }
  return covariances;
}

}  // namespace waymark
