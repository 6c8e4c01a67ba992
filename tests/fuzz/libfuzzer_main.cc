// The entry of a libFuzzer binary, which has one format: inputs are taken, or refused in one line.
#include <cstdint>
#include <cstdlib>

#include "tests/fuzz/format.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const waymark::test::Format& format = waymark::test::formats().front();
  const auto refused = format.read(std::string(data, data + size));
  if (refused &&
      (refused->message.empty() || waymark::in_one_line(refused->message) != refused->message)) {
    std::abort();
  }
  return 0;
}
