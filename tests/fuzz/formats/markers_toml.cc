#include "core/marker/marker_catalog.h"
#include "tests/fuzz/format.h"
#include "tests/support/tiny_capture.h"

namespace waymark::test {
namespace {

const char* const kSeveral =
    "[[markers]]\nfamily = \"tag36h11\"\nignore = \"200-220\"\n[[markers.sizes]]\n"
    "ids = \"100-199, 205\"\nsize_m = 0.25\n[[markers]]\nfamily = 'aruco_4x4_50'\nsize_m = 0.3\n"
    "[[markers.sizes]]\nids = [1, \"4-7\"]\nsize_m = 1e-1\n";

const AddFormat markers_toml(
    {"MarkerCatalog",
     {tiny_markers_toml(), kSeveral},
     {"[markers]", "[[markers]]", "[[markers.sizes]]", "family", "size_m", "ids", "ignore",
      "\"tag36h11\"", "\"0-999999999\"", "nan", "inf", "0x7fffffff"},
     reader([](const std::string& text) { return parse_marker_catalog(text, "markers.toml"); })});

}  // namespace
}  // namespace waymark::test
