#pragma once

namespace waymark {

/// One camera's calibration as other programs write it.
inline constexpr const char* kRosCameraInfo =
    "image_width: 640\nimage_height: 480\ncamera_name: narrow_stereo\n"
    "camera_matrix:\n  rows: 3\n  cols: 3\n"
    "  data: [560.0, 0.0, 322.5, 0.0, 561.0, 237.5, 0.0, 0.0, 1.0]\n"
    "distortion_model: plumb_bob\n"
    "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [-0.1, 0.02, 0.001, 0.002, 0.0]\n"
    "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]\n";
inline constexpr const char* kOpenCvStorage =
    "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n"
    "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
    "   data: [ 560., 0., 322.5, 0., 561., 237.5, 0., 0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
    "   data: [ -0.1, 0.02, 0.001, 0.002, 0. ]\n";

}  // namespace waymark
