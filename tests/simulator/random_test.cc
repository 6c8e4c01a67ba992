#include "simulator/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace waymark::simulator {
namespace {

TEST(Random, IsSplitmix64OnEveryMachine) {
  Random random(0);  // the reference implementation's first numbers for seed 0
  EXPECT_EQ(random.bits(), 0xE220A8397B1DCDAFULL);
  EXPECT_EQ(random.bits(), 0x6E789E6AA1B965F4ULL);
  EXPECT_EQ(random.bits(), 0x06C45D188009454FULL);
}

TEST(Random, EveryTupleHasAStreamOfItsOwn) {
  std::set<std::uint64_t> firsts;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    for (std::uint64_t camera = 0; camera < 10; ++camera) {
      firsts.insert(Random::of({seed, camera}).bits());
    }
  }
  EXPECT_EQ(firsts.size(), 100U);
  EXPECT_EQ(Random::of({3, 4}).bits(), Random::of({3, 4}).bits());
}

TEST(Random, UniformAndNormalNumbersHaveTheirMoments) {
  Random random(7);
  constexpr int kCount = 200'000;
  double mean = 0;
  double square = 0;
  for (int i = 0; i < kCount; ++i) {
    const double uniform = random.uniform(2, 4);
    EXPECT_TRUE(uniform >= 2 && uniform < 4);
    mean += uniform / kCount;
    const double normal = random.normal();
    square += normal * normal / kCount;
  }
  EXPECT_NEAR(mean, 3, 5 * 2 / std::sqrt(12.0 * kCount));
  EXPECT_NEAR(square, 1, 5 * std::sqrt(2.0 / kCount));
}

}  // namespace
}  // namespace waymark::simulator
