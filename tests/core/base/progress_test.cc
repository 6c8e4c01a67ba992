#include "core/base/progress.h"

#include <gtest/gtest.h>

#include <string>

namespace waymark {
namespace {

std::string said(bool enabled) {
  ::testing::internal::CaptureStderr();
  Progress progress(enabled);
  progress.begin("adjusting", 10);
  for (std::size_t i = 0; i <= 10; ++i) progress.update(i, "note");
  progress.end();
  progress.end();  // a stage that has ended does so once
  return ::testing::internal::GetCapturedStderr();
}

TEST(Progress, OfAShortStageIsSilentWhereNobodyWatchesATerminal) { EXPECT_EQ(said(true), ""); }

TEST(Progress, IsSilentWhereItIsNotWanted) { EXPECT_EQ(said(false), ""); }

}  // namespace
}  // namespace waymark
