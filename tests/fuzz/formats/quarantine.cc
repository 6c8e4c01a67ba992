#include "core/map/quarantine.h"

#include "tests/fuzz/format.h"

namespace waymark::test {
namespace {

const AddFormat quarantine(
    {"Quarantine",
     {R"({"map_hash": "0123456789abcdef", "markers": [
         {"id": 12, "family": "tag36h11", "state": "MOVED", "since_utime": 1800000000000000,
          "offset_m": 0.31},
         {"id": "aruco_4x4_50:7", "family": "aruco_4x4_50", "state": "UNKNOWN", "since_utime": 0,
          "offset_m": 0.0}]})"},
     {"\"map_hash\"", "\"markers\"", "\"id\"", "\"family\"", "\"state\"", "\"MOVED\"",
      "\"UNKNOWN\"", "\"since_utime\"", "\"offset_m\"", "9223372036854775808", "12.7"},
     reader([](const std::string& text) { return parse_quarantine(text, "quarantine.json"); })});

}  // namespace
}  // namespace waymark::test
