#include "mapbuilder/import/open_capture.h"

#include <gmock/gmock.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

using testing::HasSubstr;

TEST(OpenCapture, TakesEitherLayout) {
  const TemporaryFolder ours;
  ours.write("rig.yaml", tiny_rig_yaml(1));
  ours.write("markers.toml", tiny_markers_toml());
  ours.write("cam0/5.jpg", "");
  const auto capture = open_capture(ours.path());
  ASSERT_TRUE(capture) << capture.error().message;
  EXPECT_EQ(capture->images.size(), 1U);

  const TemporaryFolder papers;
  papers.write("rig.yaml", tiny_rig_yaml(1));
  papers.write("sfm.toml", "[marker]\ntype='apriltag'\nfamily='36h11'\nboard_size=0.1\n");
  papers.write("images/5.jpg", "");
  const auto data_set = open_capture(papers.path());
  ASSERT_TRUE(data_set) << data_set.error().message;
  EXPECT_EQ(data_set->images.size(), 1U);
  EXPECT_EQ(data_set->catalog.only_family(), Family::tag36h11);
}

TEST(OpenCapture, WhatIsNeitherIsNoInput) {
  const TemporaryFolder folder;
  EXPECT_EQ(open_capture(folder.path()).error().kind, ErrorKind::no_input);
  const auto absent = open_capture(folder.path() / "absent");
  ASSERT_FALSE(absent);
  EXPECT_EQ(absent.error().kind, ErrorKind::no_input);
  EXPECT_THAT(absent.error().message, HasSubstr("absent: no such capture folder"));
}

}  // namespace
}  // namespace waymark
