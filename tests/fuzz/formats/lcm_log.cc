#include "mapbuilder/import/lcm_detections.h"
#include "tests/fuzz/file_of.h"
#include "tests/fuzz/format.h"
#include "tests/support/lcm_log_text.h"

namespace waymark::test {
namespace {

std::string event_of(int set) {
  return lcm_event("WAYMARK_DETECTIONS", encoded(detections_message(set)));
}

Expected<LoggedDetections> read(const std::string& bytes) {
  Progress progress(false);
  return read_lcm_detections(file_of(bytes), {}, progress);
}

const AddFormat lcm_log({"LcmLog",
                         {event_of(0), event_of(0) + lcm_event("OTHER", "message") + event_of(1)},
                         {"\xED\xA1\xDA\x01", "WAYMARK_DETECTIONS", "tag36h11"},
                         reader(read)});

}  // namespace
}  // namespace waymark::test
