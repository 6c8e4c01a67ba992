#include "mapbuilder/import/open_capture.h"
#include "tests/fuzz/format.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark::test {
namespace {

/// The paper's layout around it, all else of which is well.
Expected<CaptureFolder> open_with(const std::string& sfm_toml) {
  static const TemporaryFolder folder;
  static const bool prepared = [] {
    folder.write("rig.yaml", tiny_rig_yaml(1));
    folder.write("detections.csv", "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3\n");
    return true;
  }();
  (void)prepared;
  folder.write("sfm.toml", sfm_toml);
  return open_capture(folder.path());
}

const AddFormat sfm_toml(
    {"SfmToml",
     {"[marker]\n# 0:ARUCO_4X4_1000\ntype = 'aruco'\nfamily = '4x4_1000'\n"
      "board_size = [[0.3, 0.25, 0.35], [['default'], ['100-199'], ['200-299', 305]]]\n",
      "[marker]\ntype = \"apriltag\"\nfamily = \"36h11\"\nboard_size = 0.2\n"},
     {"[marker]", "type", "'aruco'", "'apriltag'", "family", "'4x4_1000'", "'tag36h11'",
      "board_size", "'default'", "'100-199'", "'''", "nan", "inf", "1e-320"},
     reader(open_with)});

}  // namespace
}  // namespace waymark::test
