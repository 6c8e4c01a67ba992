#include "core/estimate/consider_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/camera/lens_kind.h"
#include "core/geometry/decompositions.h"

namespace waymark {
namespace {

/// Adds sigmas that have half their variance in common to what is there.
void add_half_common(const Eigen::VectorXd& sigmas, Eigen::MatrixXd& covariance) {
  covariance += kCommonShare * sigmas * sigmas.transpose();
  covariance.diagonal() += (1 - kCommonShare) * sigmas.cwiseAbs2();
}

/// What edges of different rigs' cameras have in common; within a rig it is in its covariance.
void relate_edges(const std::vector<ConsiderParameter>& all, Eigen::MatrixXd& covariance) {
  const auto is_edge = [&](Eigen::Index i) {
    const ConsiderParameter& one = all[static_cast<std::size_t>(i)];
    return !one.is_size() && one.of_rig.quantity == CameraQuantity::edge;
  };
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j < i && is_edge(i); ++j) {
      const auto at = [&](Eigen::Index k) { return all[static_cast<std::size_t>(k)].rig; };
      if (!is_edge(j) || at(i) == at(j)) continue;
      covariance(i, j) = covariance(j, i) =
          kCommonShare * std::sqrt(covariance(i, i) * covariance(j, j));
    }
  }
}

std::string text_of(const RigParameter& parameter) {
  constexpr std::array kNames{"position", "rotation",  "focal length", "principal point",
                              "k1",       "edge bias", "stamp",        "read-out"};
  const std::string name = kNames.at(static_cast<std::size_t>(parameter.quantity));
  const auto axis = static_cast<std::size_t>(parameter.axis);
  switch (parameter.quantity) {
    case CameraQuantity::position:
    case CameraQuantity::rotation:
      return name + " " + "xyz"[axis];
    case CameraQuantity::principal:
      return name + " " + "uv"[axis];
    default:
      return name;
  }
}

}  // namespace

ConsiderParameters consider_parameters(std::span<const Rig> rigs, std::span<const StatedSize> sizes,
                                       const SigmaCircumstances& circumstances) {
  ConsiderParameters made;
  std::vector<Eigen::MatrixXd> blocks;
  for (std::size_t r = 0; r < rigs.size(); ++r) {
    for (const RigParameter& one : rig_parameters(rigs[r])) made.all.push_back({r, one, 0});
    blocks.push_back(rig_covariance(rigs[r], circumstances));
  }
  Eigen::VectorXd size_sigmas(static_cast<Eigen::Index>(sizes.size()));
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    made.all.push_back({0, {}, sizes[i].size_m});
    size_sigmas[static_cast<Eigen::Index>(i)] = sizes[i].sigma;
  }
  Eigen::MatrixXd of_sizes = Eigen::MatrixXd::Zero(size_sigmas.size(), size_sigmas.size());
  add_half_common(size_sigmas, of_sizes);
  blocks.push_back(std::move(of_sizes));

  const auto count = static_cast<Eigen::Index>(made.all.size());
  made.covariance = Eigen::MatrixXd::Zero(count, count);
  Eigen::Index at = 0;
  for (const Eigen::MatrixXd& block : blocks) {
    made.covariance.block(at, at, block.rows(), block.cols()) = block;
    at += block.rows();
  }
  relate_edges(made.all, made.covariance);
  return made;
}

std::string name_of(const ConsiderParameter& parameter, std::span<const Rig> rigs) {
  if (parameter.is_size()) return fmt::format("size {:.6g} m", parameter.size_m);
  const std::string rig = parameter.rig == 0 ? "" : fmt::format("rig{} ", parameter.rig);
  const RigParameter& one = parameter.of_rig;
  return fmt::format("{}{} {}", rig, rigs[parameter.rig].cameras[one.camera].name, text_of(one));
}

CalibrationTangent tangent_of(const ConsiderParameter& parameter, const CameraModel& camera) {
  CalibrationTangent tangent = CalibrationTangent::Zero();
  if (parameter.is_size()) {
    tangent[kSizeRow] = 1;
    return tangent;
  }
  const int axis = parameter.of_rig.axis;
  switch (parameter.of_rig.quantity) {
    case CameraQuantity::position:
      tangent[axis] = 1;
      break;
    case CameraQuantity::rotation:
      tangent[3 + axis] = 1;
      break;
    case CameraQuantity::focal:
      tangent[kIntrinsicsRow] = camera.parameters().fu_px;
      tangent[kIntrinsicsRow + 1] = camera.parameters().fv_px;
      break;
    case CameraQuantity::principal:
      tangent[kIntrinsicsRow + 2 + axis] = 1;
      break;
    case CameraQuantity::k1:
      tangent[kIntrinsicsRow + 4 + lens_kind(camera.parameters().distortion).first_bend] = 1;
      break;
    case CameraQuantity::edge:
      tangent[kEdgeRow] = 1;
      break;
    case CameraQuantity::stamp:
    case CameraQuantity::readout:
      break;
  }
  return tangent;
}

Eigen::MatrixXd square_root_of(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd sigmas = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  const Eigen::VectorXd inverse =
      (sigmas.array() > 0).select(sigmas.cwiseInverse(), Eigen::VectorXd::Zero(sigmas.size()));
  const Eigen::MatrixXd correlations = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  const SymmetricEigen<Eigen::Dynamic> eigen = symmetric_eigen<Eigen::Dynamic>(correlations);
  return sigmas.asDiagonal() * eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
}

}  // namespace waymark
