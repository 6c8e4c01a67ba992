#include "core/map/map_json.h"

#include "tests/fuzz/format.h"
#include "tests/support/small_map.h"

namespace waymark::test {
namespace {

const char* const kByHand =
    R"({"schema": 1, "submaps": [{"frame": "facility", "markers": [{"id": "aruco_4x4_50:7",
    "family": "aruco_4x4_50", "size_m": 0.2, "position_m": [1, 2.5, 0], "sigma_m": 0.01,
    "sigma_deg": 1, "quaternion_xyzw": [0, 0, 0.7071, 0.7071]}]}]})";

const AddFormat map_json(
    {"MapJson",
     {format_map_json(small_map()), format_map_json(considered_small_map()), kByHand},
     {"\"schema\"",
      "\"submaps\"",
      "\"markers\"",
      "\"frame\"",
      "\"facility\"",
      "\"z_is_up\"",
      "\"id\"",
      "\"family\"",
      "\"tag36h11\"",
      "\"covariance\"",
      "\"covariance_metric\"",
      "\"modes\"",
      "\"parameters\"",
      "\"parameter_covariance\"",
      "\"cross\"",
      "\"position_m\"",
      "\"quaternion_xyzw\"",
      "\"sigma_m\"",
      "\"sigma_deg\"",
      "null",
      "true",
      "4294967308",
      "1e308",
      "-0.0"},
     reader([](const std::string& text) { return parse_map_json(text, "map.json"); })});

}  // namespace
}  // namespace waymark::test
