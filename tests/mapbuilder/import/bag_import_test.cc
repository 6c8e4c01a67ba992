#include "mapbuilder/import/bag_import.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "core/capture/capture_folder.h"
#include "core/capture/image_file.h"
#include "core/capture/jpeg.h"
#include "core/capture/pgm.h"
#include "tests/support/peak_memory.h"
#include "tests/support/recordings.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test_pattern.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

constexpr Stamp kStart = std::chrono::seconds(1'700'000'000);

/// Two cameras: raw and JPEG images of 64×48, with their camera_info.
std::vector<test::RecordedMessage> recording(int sets, bool with_infos = true) {
  std::vector<test::RecordedMessage> messages;
  const std::string jpeg = encode_jpeg(test_pattern(64, 48).view(), 90).value();
  for (int i = 0; i < sets; ++i) {
    const Stamp stamp = kStart + std::chrono::milliseconds(100 * i);
    messages.push_back(test::raw_image("/z/image_raw", stamp, test_pattern(64, 48)));
    messages.push_back(test::compressed_image("/a/image_raw/compressed", stamp, "jpeg", jpeg));
    messages.push_back({"/tf", "tf2_msgs/msg/TFMessage", "none of ours"});
    if (!with_infos) continue;
    messages.push_back(test::camera_info("/z/camera_info", 64, 48, 60));
    messages.push_back(test::camera_info("/a/camera_info", 64, 48, 61));
  }
  return messages;
}

class BagImportTest : public testing::Test {
 protected:
  Status import(const BagImportOptions& options) {
    Progress progress(false);
    out_.str("");
    notes_.str("");
    return import_bag(options, progress, out_, notes_);
  }
  BagImportOptions options(const fs::path& bag) {
    BagImportOptions all;
    all.bag = bag;
    all.output = folder_.path() / "room";
    return all;
  }

  const TemporaryFolder folder_;
  const fs::path mcap_ = folder_.write("a.mcap", mcap_of(recording(3), {"zstd", 4, true}));
  const fs::path markers_ = folder_.write("m.toml", tiny_markers_toml());
  std::ostringstream out_;
  std::ostringstream notes_;
};

TEST_F(BagImportTest, MakesACaptureOfEveryStorage) {
  test::write_sqlite_bag(folder_.path() / "a.db3", recording(3));
  for (const char* bag : {"a.mcap", "a.db3"}) {
    BagImportOptions chosen = options(folder_.path() / bag);
    chosen.output = folder_.path() / (std::string("room of ") + bag);
    chosen.description.markers = markers_;
    const auto imported = import(chosen);
    ASSERT_TRUE(imported) << imported.error().message;
    EXPECT_THAT(out_.str(), HasSubstr("/a/image_raw/compressed became cam0: 3 images of 64×48"));
    EXPECT_THAT(out_.str(), HasSubstr("/z/image_raw became cam1: 3 images of 64×48 px, mono8"));
    EXPECT_THAT(notes_.str(), HasSubstr("--mono"));
    const auto capture = open_capture_folder(chosen.output);
    ASSERT_TRUE(capture) << capture.error().message;
    ASSERT_EQ(capture->images.size(), 6U);
    EXPECT_EQ(capture->images[5].stamp, kStart + std::chrono::milliseconds(200));
    EXPECT_FALSE(capture->rig.has_extrinsics);
    EXPECT_FALSE(capture->monotonic);
    EXPECT_EQ(capture->rig.cameras[0].model.parameters().fu_px, 61);
    const auto raw = read_gray_image(capture->images[1].path);
    ASSERT_TRUE(raw);
    EXPECT_EQ(raw->image.pixels, test_pattern(64, 48).pixels) << "to the bit";
  }
}

TEST_F(BagImportTest, AFolderOfSeveralFilesIsOneRecording) {
  std::vector<test::RecordedMessage> messages = recording(4, false);
  const auto half = messages.begin() + 6;
  fs::create_directory(folder_.path() / "bag");
  test::write_sqlite_bag(folder_.path() / "bag/b_0.db3", {messages.begin(), half});
  test::write_sqlite_bag(folder_.path() / "bag/b_1.db3", {half, messages.end()});
  folder_.write("bag/metadata.yaml",
                "rosbag2_bagfile_information:\n  relative_file_paths: [b_0.db3, b_1.db3]\n");
  const auto imported = import(options(folder_.path() / "bag"));
  ASSERT_TRUE(imported) << imported.error().message;
  EXPECT_THAT(out_.str(), HasSubstr("8 images of 2 cameras"));
  EXPECT_THAT(notes_.str(), HasSubstr("no camera_info beside it"));
  EXPECT_THAT(notes_.str(), HasSubstr("put rig.yaml there"));
}

TEST_F(BagImportTest, TopicsAreTakenAsTheyAreNamed) {
  BagImportOptions chosen = options(mcap_);
  chosen.topics = {"/z/image_raw"};
  chosen.every = 2;
  ASSERT_TRUE(import(chosen));
  EXPECT_THAT(out_.str(), HasSubstr("/z/image_raw became cam0: 2 images"));
  EXPECT_FALSE(fs::exists(chosen.output / "cam1"));
  chosen.output = folder_.path() / "hall";
  chosen.topics = {"/y"};
  EXPECT_THAT(import(chosen).error().message,
              HasSubstr("no images of topic /y; other topics: /tf"));
}

TEST_F(BagImportTest, ARigFileMustBeOfTheseCameras) {
  BagImportOptions chosen = options(mcap_);
  chosen.description.rig = folder_.write("two.yaml", tiny_rig_yaml(2));
  ASSERT_TRUE(import(chosen)) << "two of 64×48";
  EXPECT_EQ(folder_.read("room/rig.yaml"), tiny_rig_yaml(2));
  chosen.output = folder_.path() / "hall";
  chosen.description.rig = folder_.write("three.yaml", tiny_rig_yaml(3));
  EXPECT_THAT(import(chosen).error().message, HasSubstr("3 cameras, but 2 topics"));
  std::string larger = tiny_rig_yaml(2);
  larger.replace(larger.find("[64, 48]"), 8, "[65, 48]");
  chosen.description.rig = folder_.write("larger.yaml", larger);
  EXPECT_THAT(import(chosen).error().message, HasSubstr("65×48"));
  EXPECT_FALSE(fs::exists(chosen.output));
}

TEST_F(BagImportTest, NothingIsLeftOfWhatEndsInAnError) {
  const std::string whole = folder_.read("a.mcap");
  BagImportOptions chosen = options(folder_.write("cut.mcap", whole.substr(0, whole.size() / 2)));
  const auto cut = import(chosen);
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(cut.error().message, HasSubstr("cut.mcap"));
  for (const auto& entry : fs::directory_iterator(folder_.path())) {
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("room")));
  }
  chosen.bag = folder_.write("none.mcap", test::mcap_of({{"/tf", "tf2_msgs/msg/TFMessage", "x"}}));
  EXPECT_THAT(import(chosen).error().message, HasSubstr("no images in it"));
  chosen.bag = folder_.write(
      "glitch.mcap", test::mcap_of({test::compressed_image("/a", kStart, "jpeg", "no image")}));
  EXPECT_THAT(import(chosen).error().message, HasSubstr("none of 1 images of /a can be read"));
  chosen.bag = mcap_;
  chosen.every = 0;
  EXPECT_EQ(import(chosen).error().kind, ErrorKind::usage);
}

TEST_F(BagImportTest, TakesNoOthersPlace) {
  folder_.write("room/mine", "text");
  const auto taken = import(options(mcap_));
  ASSERT_FALSE(taken);
  EXPECT_EQ(taken.error().kind, ErrorKind::cant_create);
  EXPECT_EQ(folder_.read("room/mine"), "text");
}

TEST_F(BagImportTest, ASimulatorsClockIsNoDate) {
  const auto bag = folder_.write(
      "sim.mcap",
      test::mcap_of({test::raw_image("/a", std::chrono::seconds(12), test_pattern(8, 8))}));
  ASSERT_TRUE(import(options(bag)));
  EXPECT_EQ(folder_.read("room/capture.toml"), "clock = \"monotonic\"\n");
}

TEST_F(BagImportTest, MemoryIsThatOfAnImage) {
  std::vector<test::RecordedMessage> messages;
  for (int i = 0; i < 40; ++i) {
    messages.push_back(test::raw_image("/a", kStart + Stamp(i), test_pattern(2000, 1000)));
  }
  const std::string file = mcap_of(messages, {"", 4, true});
  messages.clear();
  messages.shrink_to_fit();
  const auto bag = folder_.write("large.mcap", file);
  const std::size_t memory = test::peak_memory([&] { EXPECT_TRUE(import(options(bag))); });
  EXPECT_LT(memory, 30'000'000U) << "of 80 MB";
}

}  // namespace
}  // namespace waymark
