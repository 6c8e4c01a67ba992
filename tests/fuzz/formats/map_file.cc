#include "core/map/map_file.h"

#include "core/map/map_records.h"
#include "tests/fuzz/format.h"
#include "tests/fuzz/golden_map.h"
#include "tests/support/small_map.h"

namespace waymark::test {
namespace {

const AddFormat container(
    {"MapFile",
     {encode_map(small_map()).value(), encode_map(considered_small_map()).value(), golden_map(1),
      golden_map(2), golden_map(3)},
     {"WAYMARK\n"},
     reader([](const std::string& bytes) { return decode_map(bytes, "hall.map"); })});

}  // namespace
}  // namespace waymark::test
