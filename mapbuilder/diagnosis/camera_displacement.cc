#include "mapbuilder/diagnosis/camera_displacement.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/decompositions.h"
#include "core/geometry/degrees.h"
#include "core/geometry/so3.h"

namespace waymark {
namespace {

constexpr double kSigmas = 5.0;
constexpr double kWorthNaming_m = 0.002;
constexpr double kWorthNaming_rad = 0.1 / kDegreesPerRadian;

/// Of reference_from_cam, to first order: the reference's own errors move and turn what it sees.
Matrix6d covariance_seen_from(const Eigen::MatrixXd& covariance, const Rig& fitted,
                              std::size_t camera, std::size_t reference) {
  if (camera == reference) return Matrix6d::Zero();
  const Rigid3& seen = fitted.cameras[camera].rig_from_cam;
  const Rigid3& by = fitted.cameras[reference].rig_from_cam;
  const auto c = static_cast<Eigen::Index>(6 * camera);
  const auto r = static_cast<Eigen::Index>(6 * reference);
  Eigen::Matrix<double, 12, 12> both;
  both << covariance.block<6, 6>(c, c), covariance.block<6, 6>(c, r),  //
      covariance.block<6, 6>(r, c), covariance.block<6, 6>(r, r);
  Eigen::Matrix<double, 6, 12> by_both = Eigen::Matrix<double, 6, 12>::Zero();
  by_both.leftCols<6>().setIdentity();
  by_both.rightCols<6>() = -Matrix6d::Identity();
  by_both.block<3, 3>(0, 9) = skew(seen.translation - by.translation);
  return by_both * both * by_both.transpose();
}

double largest_sigma(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, symmetric_eigenvalues<3>(covariance)[2]));
}

}  // namespace

bool CameraDisplacement::is_worth_naming() const {
  return moved_m > std::max(kWorthNaming_m, kSigmas * moved_sigma_m) ||
         turned_rad > std::max(kWorthNaming_rad, kSigmas * turned_sigma_rad);
}

std::vector<CameraDisplacement> camera_displacements(const Rig& stated, const Rig& fitted,
                                                     const Eigen::MatrixXd& covariance,
                                                     std::size_t reference) {
  const Rigid3 was_by = stated.cameras[reference].rig_from_cam.inverse();
  const Rigid3 is_by = fitted.cameras[reference].rig_from_cam.inverse();
  std::vector<CameraDisplacement> all;
  for (std::size_t c = 0; c < stated.cameras.size(); ++c) {
    const Rigid3 was = was_by * stated.cameras[c].rig_from_cam;
    const Rigid3 is = is_by * fitted.cameras[c].rig_from_cam;
    const Matrix6d spread = covariance_seen_from(covariance, fitted, c, reference);
    all.push_back({(is.translation - was.translation).norm(),
                   angle_between_rad(is.rotation, was.rotation),
                   largest_sigma(spread.topLeftCorner<3, 3>()),
                   largest_sigma(spread.bottomRightCorner<3, 3>())});
  }
  return all;
}

std::size_t least_displacing_reference(const Rig& stated, const Rig& fitted,
                                       const Eigen::MatrixXd& covariance) {
  std::size_t best = 0;
  std::ptrdiff_t fewest = 0;
  for (std::size_t reference = 0; reference < stated.cameras.size(); ++reference) {
    const auto all = camera_displacements(stated, fitted, covariance, reference);
    const auto displaced = std::count_if(all.begin(), all.end(), [](const CameraDisplacement& one) {
      return one.is_worth_naming();
    });
    // One by which none is displaced only knows the others less surely.
    if (reference == 0 || (displaced > 0 && displaced < fewest)) {
      best = reference;
      fewest = displaced;
    }
  }
  return best;
}

}  // namespace waymark
