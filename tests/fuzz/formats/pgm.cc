#include "core/capture/pgm.h"

#include "tests/fuzz/format.h"
#include "tests/support/test_pattern.h"

namespace waymark::test {
namespace {

const AddFormat pgm({"Pgm",
                     {encode_pgm(test_pattern(40, 30).view())},
                     {},
                     reader([](const std::string& bytes) { return decode_pgm(bytes); })});

}  // namespace
}  // namespace waymark::test
