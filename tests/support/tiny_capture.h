#pragma once

#include <string>

namespace waymark {

/// rig.yaml of `cameras` pinhole cameras without distortion, 64×48 px, 0.1 m apart along x.
inline std::string tiny_rig_yaml(int cameras) {
  std::string text;
  for (int camera = 0; camera < cameras; ++camera) {
    text += "cam" + std::to_string(camera) +
            ":\n"
            "  camera_model: pinhole\n"
            "  intrinsics: [60.0, 60.0, 31.5, 23.5]\n"
            "  distortion_model: none\n"
            "  distortion_coeffs: []\n"
            "  resolution: [64, 48]\n";
    if (camera > 0) {
      text +=
          "  T_cn_cnm1:\n"
          "  - [1.0, 0.0, 0.0, -0.1]\n"
          "  - [0.0, 1.0, 0.0, 0.0]\n"
          "  - [0.0, 0.0, 1.0, 0.0]\n"
          "  - [0.0, 0.0, 0.0, 1.0]\n";
    }
  }
  return text;
}

/// markers.toml: tag36h11, 0.1 m, id 99 ignored.
inline std::string tiny_markers_toml() {
  return "[markers]\nfamily = \"tag36h11\"\nsize_m = 0.1\nignore = \"99\"\n";
}

}  // namespace waymark
