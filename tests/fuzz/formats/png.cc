#include "core/capture/png.h"

#include "tests/fuzz/format.h"
#include "tests/support/test_pattern.h"

namespace waymark::test {
namespace {

const AddFormat png({"Png",
                     {encode_png(test_pattern(40, 30).view()).value()},
                     {},
                     reader([](const std::string& bytes) { return decode_png(bytes); })});

}  // namespace
}  // namespace waymark::test
