#include "core/capture/capture_folder.h"
#include "tests/fuzz/format.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark::test {
namespace {

/// The folder around it, all else of which is well.
Expected<CaptureFolder> open_with(const std::string& capture_toml) {
  static const TemporaryFolder folder;
  static const bool prepared = [] {
    folder.write("rig.yaml", tiny_rig_yaml(1));
    folder.write("markers.toml", tiny_markers_toml());
    folder.write("detections.csv", "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3\n");
    return true;
  }();
  (void)prepared;
  folder.write("capture.toml", capture_toml);
  return open_capture_folder(folder.path());
}

const AddFormat capture_toml(
    {"CaptureToml",
     {"clock = \"monotonic\"\nsession = \"a1\"\nsync_tolerance_us = 1500\ncodec = \"pgm\"\n"
      "software = \"locd 1.0\"\n"},
     {"clock", "\"realtime\"", "\"monotonic\"", "session", "sync_tolerance_us", "codec", "software",
      "9223372036854775807"},
     reader(open_with)});

}  // namespace
}  // namespace waymark::test
