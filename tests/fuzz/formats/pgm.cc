#include "core/capture/pgm.h"

#include "tests/fuzz/format.h"
#include "tests/fuzz/image_format.h"

namespace waymark::test {
namespace {

const AddFormat pgm(
    {"Pgm",
     {encode_pgm(image_seed().view()),
      "P5 # 12 bits\n3\t2\n4095\n" + std::string("\0\1\x0F\xFF\1\2\3\4\5\6\7\x08", 12)},
     {"P5", "P6", "#", "\n", "255\n", "65535\n", "4095\n"},
     reader([](const std::string& bytes) { return read_image(bytes, pgm_size, decode_pgm); })});

}  // namespace
}  // namespace waymark::test
