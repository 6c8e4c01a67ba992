#include "core/capture/jpeg.h"

#include "tests/fuzz/format.h"
#include "tests/support/test_pattern.h"

namespace waymark::test {
namespace {

const AddFormat jpeg({"Jpeg",
                      {encode_jpeg(test_pattern(40, 30).view(), 90).value(),
                       encode_jpeg(test_pattern(40, 30).view(), 20).value()},
                      {},
                      reader([](const std::string& bytes) { return decode_jpeg(bytes); })});

}  // namespace
}  // namespace waymark::test
