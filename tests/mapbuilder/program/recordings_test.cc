// Recordings of other programs, from the file to the map.
#include "tests/support/recordings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <lcm/lcm-cpp.hpp>

#include "core/base/atomic_file.h"
#include "core/camera/rig_fingerprint.h"
#include "core/capture/capture_folder.h"
#include "core/capture/image_file.h"
#include "core/map/map_file.h"
#include "locd/publish/messages.h"
#include "simulator/render_capture.h"
#include "simulator/scene_library.h"
#include "tests/locd/pose/room_drive.h"
#include "tests/mapbuilder/program/run_program.h"
#include "tests/support/lcm_log_text.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;
using test::run_mapbuilder;
using testing::HasSubstr;

class Recordings : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_.path() / name).string();
  }

  /// Content hash of the map that is built of these inputs.
  std::string hash_of_build(std::vector<std::string> inputs) {
    const std::string map = path("built " + std::to_string(builds_++) + ".map");
    inputs.insert(inputs.begin(), "build");
    inputs.insert(inputs.end(), {"-o", map});
    const auto built = run_mapbuilder(inputs);
    EXPECT_EQ(built.exit_code, 0) << built.err;
    const auto read = read_map_file(map);
    EXPECT_TRUE(read);
    last_ = read ? *read : MarkerMap{};
    return read ? content_hash(*read) : "none";
  }

  const test::TemporaryFolder folder_;
  MarkerMap last_;  ///< that was built
  int builds_ = 0;
};

/// Images of a capture as a driver's messages: JPEG as they are, or raw.
std::vector<test::RecordedMessage> messages_of(const CaptureFolder& capture, bool raw) {
  std::vector<test::RecordedMessage> messages;
  for (const ImageFile& image : capture.images) {
    const std::string camera = "/cam" + std::to_string(image.camera);
    if (raw) {
      messages.push_back(test::raw_image(camera + "/image_raw", image.stamp,
                                         read_gray_image(image.path).value().image));
    } else {
      messages.push_back(test::compressed_image(camera + "/image_raw/compressed", image.stamp,
                                                "jpeg", read_file(image.path).value()));
    }
  }
  return messages;
}

TEST_F(Recordings, OfImagesGiveTheMapOfTheirCapture) {
  simulator::RenderJob job;
  job.positions = 12;
  job.show_progress = false;
  job.settings.jpeg_quality = 95;
  const std::atomic<bool> stop{false};
  const auto scene = simulator::load_scene("room1");
  const auto rig = simulator::load_rig("cg120");
  ASSERT_TRUE(scene && rig);
  ASSERT_TRUE(render_capture(*scene, *rig, job, path("room"), stop));
  const auto capture = open_capture_folder(path("room"));
  ASSERT_TRUE(capture) << capture.error().message;
  test::write_sqlite_bag(path("raw.db3"), messages_of(*capture, true));
  folder_.write("jpeg.mcap", test::mcap_of(messages_of(*capture, false), {"zstd", 3, true}));
  folder_.write("raw.mcap", test::mcap_of(messages_of(*capture, true), {"lz4", 2, true}));
  const std::string hash = hash_of_build({path("room")});
  for (const char* bag : {"raw.db3", "jpeg.mcap", "raw.mcap"}) {
    const std::string imported = path(std::string(bag) + " capture");
    const auto run =
        run_mapbuilder({"import", path(bag), "-o", imported, "--rig", path("room/rig.yaml"),
                        "--markers", path("room/markers.toml")});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(hash_of_build({imported}), hash) << bag;
  }
}

/// What locd sends of a room, written as a log by LCM itself.
void log_drive(const test::RoomDrive& drive, const MarkerMap& map, const Rig& rig,
               const std::string& log) {
  lcm::LCM lcm("file://" + log + "?mode=w");
  ASSERT_TRUE(lcm.good());
  SessionFacts session;
  session.session_id = "0123456789abcdef";
  session.cameras = rig.cameras.size();
  session.rig = fingerprint(rig);
  detections_t message = make_detections_message(session);
  Localizer localizer(rig, map, {});
  PoseEstimate estimate;
  ClockOffset clock(ClockReading{});
  for (std::size_t i = 0; i < drive.size(); ++i) {
    localizer.localize(drive.set(i), estimate);
    fill_detections(estimate, session, clock, message);
    message.seq = static_cast<std::int64_t>(i);
    ASSERT_EQ(lcm.publish("WAYMARK_DETECTIONS", &message), 0);
  }
}

/// Largest distance between places of the same marker.
double farthest_apart_m(const MarkerMap& a, const MarkerMap& b) {
  const auto& ours = a.submaps.front().markers;
  const auto& theirs = b.submaps.front().markers;
  EXPECT_EQ(ours.size(), theirs.size());
  double farthest = 0;
  for (std::size_t i = 0; i < std::min(ours.size(), theirs.size()); ++i) {
    EXPECT_EQ(ours[i].id, theirs[i].id);
    const Eigen::Vector3d apart =
        ours[i].world_from_marker.translation - theirs[i].world_from_marker.translation;
    farthest = std::max(farthest, apart.norm());
  }
  return farthest;
}

TEST_F(Recordings, OfDetectionsGiveTheMapOfTheirCapture) {
  test::RoomOptions room;
  room.noise_px = 0.2;
  room.state_covariances = true;
  const test::RoomDrive drive(test::make_room(room));
  const test::SyntheticRoom made = test::make_room(room);
  test::write_capture(made, path("room"));
  // With the numbers that the rig file has.
  const auto capture = open_capture_folder(path("room"));
  ASSERT_TRUE(capture);
  log_drive(drive, test::room_map(made), capture->rig, path("a.lcm"));
  (void)hash_of_build({path("room")});
  const MarkerMap of_capture = last_;
  const std::vector<std::string> described{"--rig", path("room/rig.yaml"), "--markers",
                                           path("room/markers.toml")};
  std::vector<std::string> import{"import", path("a.lcm"), "-o", path("imported")};
  import.insert(import.end(), described.begin(), described.end());
  const auto run = run_mapbuilder(import);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("60 frame sets of 3 cameras"));
  // 0.00005 px is what detections.csv rounds by, and what float does.
  constexpr double kRounding_m = 1e-5;
  (void)hash_of_build({path("imported")});
  EXPECT_LT(farthest_apart_m(last_, of_capture), kRounding_m);
  EXPECT_EQ(last_.rig_fingerprint, of_capture.rig_fingerprint);
  std::vector<std::string> straight{path("a.lcm")};
  straight.insert(straight.end(), described.begin(), described.end());
  (void)hash_of_build(straight);
  EXPECT_LT(farthest_apart_m(last_, of_capture), kRounding_m);
}

TEST_F(Recordings, DetectMakesATableOfALog) {
  folder_.write("a.lcm",
                test::lcm_event("WAYMARK_DETECTIONS", test::encoded(test::detections_message(0))));
  const auto unnamed = run_mapbuilder({"detect", path("a.lcm"), "--rig", path("r.yaml")});
  EXPECT_EQ(unnamed.exit_code, 64) << unnamed.err;
  const auto bare = run_mapbuilder({"detect", path("a.lcm"), "-o", path("d.csv")});
  EXPECT_EQ(bare.exit_code, 64) << bare.err;
  EXPECT_THAT(bare.err, HasSubstr("needs both --rig and --markers"));
}

TEST_F(Recordings, BadOnesEndIn65WithOneLine) {
  folder_.write("ros1.bag", "#ROSBAG V2.0\n");
  folder_.write("a.mcap", "\x89MCAP0\r\n");
  folder_.write("a.db3", std::string("SQLite format 3\0 and nothing more", 33));
  folder_.write("a.lcm", "\xED\xA1\xDA\x01 cut");
  folder_.write("a.zstd", "\x28\xB5\x2F\xFD packed");
  fs::create_directory(path("folder"));
  for (const char* bad : {"ros1.bag", "a.mcap", "a.db3", "a.lcm", "a.zstd", "folder"}) {
    const auto run = run_mapbuilder({"import", path(bad), "-o", path("room")});
    EXPECT_EQ(run.exit_code, 65) << bad << run.err;
    EXPECT_EQ(test::error_lines(run), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr(bad));
    EXPECT_FALSE(fs::exists(path("room")));
  }
}

}  // namespace
}  // namespace waymark
