// Whatever is read from outside, damaged a hundred thousand times: no crash, no endless loop
// (ctest's time limit), no memory beyond reason, and for each refusal one line that says something.
// The asan and ubsan presets see what a plain build survives by luck.
#include <gtest/gtest.h>

#include "tests/fuzz/format.h"
#include "tests/fuzz/mutator.h"
#include "tests/support/sanitized.h"

namespace waymark::test {
namespace {

constexpr int kInputs = kSanitized ? 4'000 : 100'000;  ///< of each form

class DamagedInputs : public testing::TestWithParam<Format> {};

TEST_P(DamagedInputs, AreTakenOrRefusedInOneLine) {
  const Format& format = GetParam();
  for (const std::string& seed : format.seeds) {
    const auto refused = format.read(seed);
    ASSERT_FALSE(refused) << refused->message;
  }
  Mutator mutator(format.seeds, format.words, 20260101);
  int refusals = 0;
  for (int i = 0; i < kInputs; ++i) {
    const auto refused = format.read(mutator.next());
    if (!refused) continue;
    ++refusals;
    EXPECT_FALSE(refused->message.empty()) << i;
    EXPECT_EQ(in_one_line(refused->message), refused->message);
  }
  EXPECT_GT(refusals, kInputs / 10) << "damage that nobody notices is no test";
}

INSTANTIATE_TEST_SUITE_P(Formats, DamagedInputs, testing::ValuesIn(formats()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace waymark::test
