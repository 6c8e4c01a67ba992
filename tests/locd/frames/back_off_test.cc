#include "locd/frames/back_off.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

using std::chrono::milliseconds;

TEST(BackOff, DoublesToFiveSecondsAndBeginsAnew) {
  BackOff back_off;
  for (const int ms : {100, 200, 400, 800, 1600, 3200, 5000, 5000}) {
    EXPECT_EQ(back_off.next(), milliseconds(ms));
  }
  back_off.begin_anew();
  EXPECT_EQ(back_off.next(), milliseconds(100));
}

}  // namespace
}  // namespace waymark
