#include "locd/service/log_limiter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace waymark {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;
using testing::HasSubstr;

TEST(LogLimiter, AnHourOfEveryCameraFlappingAtOneHertzStaysBelowTwoHundredLines) {
  LogLimiter limiter;
  int lines = 0;
  for (Stamp now{0}; now < std::chrono::hours(1); now += seconds(1)) {
    for (const char* what :
         {"cam0 lost", "cam1 lost", "cam2 lost", "cam0 back", "cam1 back", "cam2 back"}) {
      lines += limiter.admit(what, now) ? 1 : 0;
    }
    lines += limiter.summary(now) ? 1 : 0;
  }
  EXPECT_GE(lines, 6 + 50);
  EXPECT_LE(lines, 6 + 60);
}

TEST(LogLimiter, NothingIsLostFromTheCount) {
  LogLimiter limiter;
  EXPECT_TRUE(limiter.admit("cam0 lost", seconds(0)));
  for (int i = 1; i <= 7; ++i) EXPECT_FALSE(limiter.admit("cam0 lost", seconds(i)));
  EXPECT_FALSE(limiter.summary(seconds(60)).has_value());  // a minute from the first one counted
  const auto line = limiter.summary(seconds(61));
  ASSERT_TRUE(line);
  EXPECT_THAT(*line, HasSubstr("cam0 lost (7 times)"));
  EXPECT_FALSE(limiter.summary(minutes(5)));
}

TEST(LogLimiter, WhatHasNotHappenedForTenMinutesIsNews) {
  LogLimiter limiter;
  EXPECT_TRUE(limiter.admit("x", seconds(0)));
  EXPECT_FALSE(limiter.admit("x", minutes(10) - seconds(1)));
  EXPECT_TRUE(limiter.admit("x", minutes(20) - seconds(1)));
}

TEST(LogLimiter, ManyDifferentSubjectsAreLimitedToo) {
  LogLimiter limiter;
  int lines = 0;
  for (int i = 0; i < 3600; ++i) {
    lines += limiter.admit("marker " + std::to_string(i), seconds(i)) ? 1 : 0;
    lines += limiter.summary(seconds(i)) ? 1 : 0;
  }
  EXPECT_LE(lines, 200);
  EXPECT_GE(lines, LogLimiter::kMaxFirst);
}

TEST(LogLimiter, RemembersNoSubjectForLongerThanItMatters) {
  LogLimiter limiter;
  for (int i = 0; i < 1000; ++i) {
    static_cast<void>(limiter.admit("recording " + std::to_string(i), i * minutes(11)));
    EXPECT_LE(limiter.subjects(), 2U);
  }
}

}  // namespace
}  // namespace waymark
