#include "locd/record/recording_files.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(RecordingFiles, AnImageIsNamedByItsStamp) {
  EXPECT_EQ(image_name(Stamp(1'800'000'000'000'000'000), "pgm"), "1800000000000000000.pgm");
  EXPECT_EQ(image_name(Stamp(7), "jpeg"), "7.jpg");
  EXPECT_EQ(stamp_of_image("1800000000000000000.pgm"), Stamp(1'800'000'000'000'000'000));
  EXPECT_EQ(stamp_of_image("7.jpg"), Stamp(7));
}

TEST(RecordingFiles, WhatLocdDoesNotNameSoIsNoImage) {
  for (const char* name :
       {"", ".pgm", "7", "7.png", "7.PGM", "7.pgm.pgm", "7.pgm~", " 7.pgm", "+7.pgm", "-7.pgm",
        "7.5.pgm", "seven.pgm", "99999999999999999999.pgm", ".7.pgm.part"}) {
    EXPECT_EQ(stamp_of_image(name), std::nullopt) << name;
  }
}

TEST(RecordingFiles, WhatAKillLeavesIsKnownByItsName) {
  EXPECT_TRUE(is_unfinished(unfinished_name("7.pgm")));
  EXPECT_TRUE(is_unfinished(unfinished_name("7.jpg")));
  EXPECT_TRUE(is_unfinished(".frames.csv.0123456789abcdef"));
  EXPECT_TRUE(is_unfinished(".capture.toml.0123456789abcdef"));
  for (const char* name : {"", ".", "7.pgm", ".7.part", ".notes.part", ".frames.csv",
                           ".frames.csv.", "frames.csv.1", ".frames.csvx.1", ".notes.txt.1"}) {
    EXPECT_FALSE(is_unfinished(name)) << name;
  }
}

TEST(RecordingFiles, CamerasFoldersAreNumbered) {
  EXPECT_TRUE(is_camera_folder("cam0"));
  EXPECT_TRUE(is_camera_folder("cam15"));
  for (const char* name : {"", "cam", "camera", "cam-1", "cam0x", "Cam0", "report"}) {
    EXPECT_FALSE(is_camera_folder(name)) << name;
  }
}

}  // namespace
}  // namespace waymark
