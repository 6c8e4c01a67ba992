#include "mapbuilder/import/calib_json.h"

#include "tests/fuzz/format.h"

namespace waymark::test {
namespace {

const AddFormat calib_json(
    {"CalibJson",
     {R"({"camera_matrix": [[600, 0, 320], [0, 610, 240], [0, 0, 1]],
          "dist": [0.1, -0.2, 0, 0], "width": 640, "height": 480})",
      R"({"fx": 600, "fy": 610.5, "cx": 320, "cy": 240, "distortion": [[0.1, 0, 0, 0, 0]],
          "resolution": [640, 480]})",
      R"({"K": {"rows": 3, "cols": 3, "dt": "d", "data": [600, 0, 320, 0, 610, 240, 0, 0, 1]},
          "dist": []})"},
     {"\"camera_matrix\"", "\"K\"", "\"data\"", "\"fx\"", "\"dist\"", "\"distortion\"",
      "\"resolution\"", "\"width\"", "\"height\""},
     reader([](const std::string& text) { return parse_calib_json(text, "calib.json"); })});

}  // namespace
}  // namespace waymark::test
