#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/camera/rig.h"

namespace waymark {

/// Which number of a camera.
enum class CameraQuantity { position, rotation, focal, principal, k1, edge, stamp, readout };

/// One number of a rig that may be wrong in the same way in every image.
struct RigParameter {
  std::size_t camera = 0;  ///< in the rig
  CameraQuantity quantity = CameraQuantity::position;
  int axis = 0;  ///< position, rotation: 0–2 of the rig; principal point: 0 u, 1 v; else 0

  bool operator==(const RigParameter&) const = default;
};

/// Whether a camera's place is where it is by definition: the rig's frame is its own.
[[nodiscard]] bool is_rig_frame(const RigCamera& camera);

/// What may be wrong of a rig, camera by camera in the order of CameraQuantity: the order of
/// `sigma_joint`. Not among them: the place of a camera that is the rig's frame (nor of any camera
/// where transforms are not stated), k1, which is the first coefficient that bends (lens_kind.h),
/// of a lens without any, read-out of a global shutter.
[[nodiscard]] std::vector<RigParameter> rig_parameters(const Rig& rig);

/// One standard deviation of each number of a camera: as stated or else by default_sigmas; 0 of
/// what is not among rig_parameters.
[[nodiscard]] CameraSigmas sigmas_of(const RigCamera& camera,
                                     const SigmaCircumstances& circumstances = {});

/// That of one parameter; m, rad, share, px, 1 and s as SigmasOf has them.
[[nodiscard]] double sigma_of(const RigParameter& parameter, const CameraSigmas& sigmas);

/// Covariance of rig_parameters in those units: `joint_sigmas` where the rig has them, else
/// independent numbers but for edges, of which half the variance is common to all cameras.
[[nodiscard]] Eigen::MatrixXd rig_covariance(const Rig& rig,
                                             const SigmaCircumstances& circumstances = {});

/// Of two edges' covariance, or that of two print sizes, so much is common: one kind of blooming,
/// one printer.
inline constexpr double kCommonShare = 0.5;

/// States what was measured of one camera: the sigma of a quantity, of every axis of it. Joint
/// sigmas then say the same: what was measured anew errs independently of all else.
void state_sigma(std::size_t camera, CameraQuantity quantity, double sigma, Rig& rig);

/// Drops joint sigmas that are of other parameters than the rig has now: a lens that was stated
/// without distortion may have some since.
void drop_unfit_joint_sigmas(Rig& rig);

/// The rig that a camera alone is, its own frame; joint sigmas are those of its numbers in `rig`.
[[nodiscard]] Rig single_camera_rig(const Rig& rig, std::size_t camera);

/// The rig with sigmas that state it as exact, each 1e-9 of its unit: what a simulator knows.
[[nodiscard]] Rig stated_exact(Rig rig);

/// What to tell of a rig that states no sigma of any number, once: which are taken. nullopt of any
/// other. `name` stands for its file.
[[nodiscard]] std::optional<std::string> note_of_default_sigmas(const Rig& rig,
                                                                const std::string& name);

}  // namespace waymark
