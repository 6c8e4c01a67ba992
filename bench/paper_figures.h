#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace waymark::bench {

/// One row of the paper's Tables II and III ("Ours-…"), and the bars that ours must meet.
struct PaperRow {
  std::string_view scene, rig;
  double marker_deg, marker_m, camera_deg, camera_m, time_s;
};

inline constexpr std::array<PaperRow, 18> kPaperRows = {{
    {"room1", "mono", 0.912, 0.096, 4.362, 0.364, 154},
    {"room1", "cg60", 0.736, 0.076, 2.009, 0.150, 205},
    {"room1", "cg120", 0.753, 0.085, 0.692, 0.069, 201},
    {"room2", "mono", 0.799, 0.085, 1.834, 0.224, 185},
    {"room2", "cg60", 0.821, 0.088, 1.691, 0.253, 286},
    {"room2", "cg120", 0.998, 0.102, 0.986, 0.109, 281},
    {"pool", "mono", 6.930, 2.211, 5.313, 2.288, 2778},
    {"pool", "cg60", 1.221, 0.113, 2.517, 1.952, 1730},
    {"pool", "cg120", 0.921, 0.109, 0.912, 0.105, 1555},
    {"corridor", "mono", 0.923, 0.096, 0.970, 0.097, 1221},
    {"corridor", "cg60", 1.112, 0.113, 1.308, 0.146, 773},
    {"corridor", "cg120", 0.692, 0.041, 0.659, 0.045, 907},
    {"warehouse", "mono", 1.269, 0.127, 8.765, 1.335, 2521},
    {"warehouse", "cg60", 0.771, 0.071, 0.927, 0.091, 2134},
    {"warehouse", "cg120", 0.604, 0.062, 0.685, 0.071, 3129},
    {"calibration", "mono", 1.021, 0.092, 1.076, 0.104, 2293},
    {"calibration", "cg60", 0.544, 0.052, 1.321, 0.168, 521},
    {"calibration", "cg120", 0.405, 0.039, 0.812, 0.083, 651},
}};

[[nodiscard]] constexpr std::optional<PaperRow> paper_row(std::string_view scene,
                                                          std::string_view rig) {
  for (const PaperRow& row : kPaperRows) {
    if (row.scene == scene && row.rig == rig) return row;
  }
  return std::nullopt;
}

/// Absolute bars of Tables II and III.
[[nodiscard]] constexpr double marker_bar_m(std::string_view scene) {
  if (scene == "pool") return 0.012;
  if (scene == "corridor" || scene == "warehouse") return 0.008;
  return 0.005;
}
inline constexpr double kMarkerBar_deg = 0.15;
/// Of camera groups; mono may have four times its own bound.
[[nodiscard]] constexpr double camera_bar_m(std::string_view scene) {
  return scene == "pool" ? 0.006 : 0.003;
}
inline constexpr double kCameraBar_deg = 0.03;
inline constexpr double kMonoCameraBounds = 4.0;
/// Of each row's own bound, beside what its measured edge bias explains.
inline constexpr double kMostBounds = 1.5;
/// Images to map, of the paper's time.
inline constexpr double kMostOfPapersTime = 1.0 / 20.0;

/// One row of the paper's Table IV: CG-120's accuracy by observation weight.
struct PaperWeightRow {
  std::string_view scene, weight;
  double marker_deg, marker_m, camera_deg, camera_m;
};

inline constexpr std::array<PaperWeightRow, 12> kPaperWeightRows = {{
    {"room1", "L", 1.209, 0.098, 1.158, 0.094},
    {"room1", "L_d", 1.239, 0.093, 1.009, 0.084},
    {"room1", "L_d/theta", 1.253, 0.108, 1.092, 0.089},
    {"room1", "L_all", 0.753, 0.085, 0.692, 0.069},
    {"warehouse", "L", 1.250, 0.101, 1.665, 0.143},
    {"warehouse", "L_d", 1.271, 0.112, 1.302, 0.119},
    {"warehouse", "L_d/theta", 0.994, 0.089, 1.085, 0.098},
    {"warehouse", "L_all", 0.604, 0.062, 0.685, 0.071},
    {"calibration", "L", 1.088, 0.092, 1.201, 0.149},
    {"calibration", "L_d", 1.283, 0.129, 1.420, 0.235},
    {"calibration", "L_d/theta", 0.545, 0.048, 1.193, 0.092},
    {"calibration", "L_all", 0.405, 0.039, 0.812, 0.083},
}};

}  // namespace waymark::bench
