#include "core/capture/detections_csv.h"

#include "core/camera/kalibr.h"
#include "tests/fuzz/format.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark::test {
namespace {

/// The table is read block by block, so from a file.
Expected<DetectionsTable> read_table(const std::string& text) {
  static const TemporaryFolder folder;
  static const Rig rig = parse_camchain(tiny_rig_yaml(2), "rig.yaml")->rig;
  static const MarkerCatalog catalog = *parse_marker_catalog(tiny_markers_toml(), "markers.toml");
  return read_detections_csv(folder.write("detections.csv", text), rig, catalog);
}

constexpr const char* kHeader = "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3";
constexpr const char* kCovariances =
    ",hamming,sxx0,sxy0,syy0,sxx1,sxy1,syy1,sxx2,sxy2,syy2,sxx3,sxy3,syy3\n";

const AddFormat detections_csv(
    {"DetectionsCsv",
     {std::string(kHeader) +
          "\n1511000000000000000,cam0,3,1,1,9,1,9,9,1,9\n1511000000033333333,cam1,,,,,,,,,\n"
          "1511000000066666667,cam0,tag36h11:4,1.5,1,9,1,9,9.25,1,9\n",
      std::string(kHeader) + kCovariances +
          "5,cam0,3,1,1,9,1,9,9,1,9,1,0.1,0,0.2,1,0,1,1,0,1,1e-6,-2e-7,1e-6\n"},
     {"t_ns", "camera", "marker_id", "hamming", "family", "tag36h11:", "sxx0", ";", "\t", "\"",
      "1.7e18", "1700000000", "\xFF\xFE", "# detector=x markers="},
     reader(read_table)});

}  // namespace
}  // namespace waymark::test
