#pragma once

#include "core/marker/family.h"

namespace waymark {

/// Whether OpenCV 4.6 has a dictionary of this family's codes.
[[nodiscard]] constexpr bool is_in_opencv(Family family) { return family <= Family::tag36h11; }

/// Number of OpenCV's predefined ArUco dictionary with this family's codes.
[[nodiscard]] constexpr int opencv_dictionary(Family family) { return static_cast<int>(family); }

/// OpenCV's AprilTag dictionaries are turned by 180° against the pictures that AprilTag itself
/// publishes and its library draws (apriltag_to_image), for every id of all four families. What
/// AprilTag draws is upright: a picture from OpenCV's dictionary is read backwards, and OpenCV's
/// corner i is ours (i + 2) mod 4.
[[nodiscard]] constexpr bool opencv_draws_upside_down(Family family) {
  return family >= Family::tag16h5 && family <= Family::tag36h11;
}

}  // namespace waymark
