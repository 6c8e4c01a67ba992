#include "core/base/fingerprint.h"

#include <gtest/gtest.h>

#include <array>

namespace waymark {
namespace {

TEST(Fingerprint, DependsOnWhatIsAddedAndOnItsOrder) {
  const auto of = [](std::string_view first, std::string_view second) {
    Fingerprint hash;
    hash.add(first);
    hash.add(second);
    return hash.hexadecimal();
  };
  EXPECT_EQ(of("a", "bc").size(), 16U);
  EXPECT_EQ(of("a", "bc"), of("a", "bc"));
  EXPECT_NE(of("a", "bc"), of("ab", "c"));
  EXPECT_NE(of("a", "bc"), of("bc", "a"));
}

TEST(Fingerprint, OfSeveralNumbersIsThatOfEach) {
  Fingerprint together;
  together.add(std::array{1.0, -2.5});
  Fingerprint each;
  each.add(1.0);
  each.add(-2.5);
  EXPECT_EQ(together.hexadecimal(), each.hexadecimal());
}

}  // namespace
}  // namespace waymark
