#include "locd/frames/set_pacer.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

using std::chrono::milliseconds;

/// Sets every 33 ms, each taking `duration` to localize: indices of those taken.
std::vector<int> run(SetPacer& pacer, int sets, Stamp duration, int first = 0) {
  std::vector<int> taken;
  for (int i = first; i < first + sets; ++i) {
    if (!pacer.admit(i * milliseconds(33))) continue;
    taken.push_back(i);
    pacer.finished(duration);
  }
  return taken;
}

TEST(SetPacer, TakesEverySetWhileTheMachineKeepsUp) {
  SetPacer pacer;
  EXPECT_EQ(run(pacer, 1000, milliseconds(31)).size(), 1000U);
  EXPECT_EQ(pacer.divisor(), 1);
  EXPECT_EQ(pacer.skipped(), 0U);
}

struct Load {
  int duration_ms;
  int divisor;
};
class Overload : public testing::TestWithParam<Load> {};

TEST_P(Overload, ThinsEvenly) {
  SetPacer pacer;
  run(pacer, 400, milliseconds(GetParam().duration_ms));
  EXPECT_EQ(pacer.divisor(), GetParam().divisor);
  const auto taken = run(pacer, 120, milliseconds(GetParam().duration_ms), 400);
  for (std::size_t i = 1; i < taken.size(); ++i) {
    EXPECT_EQ(taken[i] - taken[i - 1], GetParam().divisor);
  }
}

INSTANTIATE_TEST_SUITE_P(SetPacer, Overload,
                         testing::Values(Load{31, 1}, Load{32, 2}, Load{60, 2}, Load{64, 3},
                                         Load{90, 3}, Load{10'000, SetPacer::kMaxDivisor}));

TEST(SetPacer, OneHiccupChangesNothing) {
  SetPacer pacer;
  run(pacer, 64, milliseconds(20));
  run(pacer, 1, milliseconds(500), 64);
  run(pacer, 200, milliseconds(20), 65);
  EXPECT_EQ(pacer.divisor(), 1);
  EXPECT_EQ(pacer.skipped(), 0U);
}

TEST(SetPacer, ReturnsWhenTheMachineIsFastAgain) {
  SetPacer pacer;
  run(pacer, 400, milliseconds(90));
  EXPECT_EQ(pacer.divisor(), 3);
  run(pacer, 1000, milliseconds(20), 400);
  EXPECT_EQ(pacer.divisor(), 1);
}

TEST(SetPacer, DoesNotSwingAtTheEdge) {
  SetPacer pacer;
  run(pacer, 400, milliseconds(32));  // just too much for every set
  EXPECT_EQ(pacer.divisor(), 2);
  run(pacer, 4000, milliseconds(27), 400);  // 0.82 of a period: would be just enough
  EXPECT_EQ(pacer.divisor(), 2);
  run(pacer, 400, milliseconds(24), 4400);  // 0.73
  EXPECT_EQ(pacer.divisor(), 1);
}

TEST(SetPacer, AGapOfTheCamerasIsNoSlowerRig) {
  SetPacer pacer;
  run(pacer, 100, milliseconds(20));
  run(pacer, 400, milliseconds(60), 1000);  // 30 s later
  EXPECT_EQ(pacer.divisor(), 2);
}

}  // namespace
}  // namespace waymark
