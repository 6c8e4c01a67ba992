#pragma once

#include <optional>
#include <span>

#include "core/camera/camera_model.h"
#include "core/marker/marker_geometry.h"

namespace waymark {

/// A camera's numbers as the squareness of its markers tells them: no map, no rig and no size is
/// asked, for a square has eight numbers in the image and a pose of its own takes six of them.
struct LensOfSquares {
  CameraParameters parameters;
  /// What corners are worth per axis (px), by what markers' own poses leave: the median, so that a
  /// few wrong outlines have no say.
  double own_px = 0;
};

/// The same of a camera whose numbers are known; infinite where nothing can be judged.
[[nodiscard]] double own_misfit_px(const CameraModel& camera,
                                   std::span<const ImageCorners> squares);

/// The numbers near those stated, or far from them, that fit the squares best: started from focal
/// lengths of a quarter to four times the stated one, several principal points, the lens as stated
/// and straight, and squeezed images. At most 300 squares, evenly spread. A lens stated straight
/// may bend (radtan). nullopt for fewer than 20 squares.
[[nodiscard]] std::optional<LensOfSquares> lens_of_squares(const CameraParameters& stated,
                                                           std::span<const ImageCorners> squares);

/// What the squares say of a stated camera.
struct LensBySquares {
  std::size_t squares = 0;
  double stated_px = 0;  ///< own_misfit_px() of the stated camera
  LensOfSquares best;    ///< near the stated one unless that is contradicted

  /// Eight numbers take a twentieth from the misfit of eighty squares, and a median of so many
  /// scatters by a tenth: by 1.4 only another lens does.
  [[nodiscard]] bool contradicts() const { return stated_px > 1.4 * best.own_px; }
};

/// A camera near the stated one first; lens_of_squares() only where that fits so much better that
/// the stated one can't be it. nullopt for fewer than 20 squares.
[[nodiscard]] std::optional<LensBySquares> judge_lens(const CameraModel& stated,
                                                      std::span<const ImageCorners> squares);

}  // namespace waymark
