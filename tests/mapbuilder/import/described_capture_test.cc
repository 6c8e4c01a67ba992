#include "mapbuilder/import/described_capture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(DescribedCapture, CopiesToTheByteWhatCanBeRead) {
  const TemporaryFolder folder;
  const std::string rig = "# mine\n" + tiny_rig_yaml(1);
  const auto named = folder.write("mine.yaml", rig);
  ASSERT_TRUE(describe_capture({named, {}}, folder.path()));
  EXPECT_EQ(folder.read("rig.yaml"), rig);
  std::ostringstream notes;
  tell_what_is_missing(folder.path(), notes);
  EXPECT_THAT(notes.str(), HasSubstr("put markers.toml there"));
  EXPECT_THAT(notes.str(), Not(HasSubstr("rig.yaml")));
}

TEST(DescribedCapture, WhatCanNotBeReadIsNotCopied) {
  const TemporaryFolder folder;
  const auto bad = folder.write("bad", "[[[");
  EXPECT_FALSE(describe_capture({bad, {}}, folder.path()));
  EXPECT_FALSE(describe_capture({{}, bad}, folder.path()));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "rig.yaml"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "markers.toml"));
}

}  // namespace
}  // namespace waymark
