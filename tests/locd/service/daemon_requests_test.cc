// What operators ask of the daemon, beside recordings.
#include <nlohmann/json.hpp>

#include "core/camera/kalibr.h"
#include "core/capture/capture_folder.h"
#include "tests/locd/service/daemon_fixture.h"

namespace waymark {
namespace {

using std::chrono::seconds;
using test::DaemonTest;
using testing::HasSubstr;
using testing::StartsWith;

class DaemonRequestsTest : public DaemonTest {
 protected:
  [[nodiscard]] nlohmann::json ask_for_json(const std::string& line) {
    return nlohmann::json::parse(request("json " + line));
  }
};

TEST_F(DaemonRequestsTest, StatusTellsHowCamerasAre) {
  start();
  EXPECT_EQ(ask_for_json("status")["text"], "not recording");
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return !statuses_.empty() && statuses_.back().cameras[1].frames > 2;
  }));
  const auto status = ask_for_json("status");
  EXPECT_EQ(status["ok"], true);
  EXPECT_EQ(status["map_hash"], content_hash(test::small_map()));
  ASSERT_EQ(status["cameras"].size(), 2U);
  EXPECT_EQ(status["cameras"][1]["name"], "cam1");
  EXPECT_EQ(status["cameras"][1]["state"], "streaming");
  EXPECT_EQ(status["recording"], false);
  EXPECT_TRUE(status["ignored"].empty());
}

TEST_F(DaemonRequestsTest, ARecordingHasTheNameThatWasAskedFor) {
  start();
  for (const char* name : {"a/b", "..\\x", "two words", "\xc3\xa4"}) {
    EXPECT_EQ(ask_for_json(std::string("start ") + name)["code"], 64) << name;
  }
  const auto answer = ask_for_json("start hall-3");
  EXPECT_THAT(answer["folder"].get<std::string>(), testing::EndsWith("Z-hall-3"));
  EXPECT_EQ(ask_for_json("start")["code"], 64) << "one runs";
}

TEST_F(DaemonRequestsTest, MarksStandInTheRecordingOnTheClockOfItsImages) {
  start();
  EXPECT_EQ(ask_for_json("mark too early")["code"], 69);
  const std::string folder = ask_for_json("start")["folder"];
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return !statuses_.empty() && statuses_.back().recorded_sets > 3;
  }));
  const auto marked = ask_for_json("mark shelf 3, \"left\"");
  EXPECT_THAT(request("mark"), StartsWith("ok marked "));
  EXPECT_THAT(request("stop"), StartsWith("ok "));
  const std::string table = tmp_.read(std::filesystem::relative(folder, tmp_.path()) / "marks.csv");
  const auto t_ns = marked["t_ns"].get<std::int64_t>();
  EXPECT_THAT(table,
              StartsWith("t_ns,text\n" + std::to_string(t_ns) + ",\"shelf 3, \"\"left\"\"\"\n"));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3);
  const auto capture = open_capture_folder(folder);
  ASSERT_TRUE(capture) << capture.error().message;
  EXPECT_LT(std::abs(t_ns - capture->images.back().stamp.count()), 60'000'000'000);
}

TEST_F(DaemonRequestsTest, AReloadIsAnsweredWhenItIsDone) {
  start();
  EXPECT_EQ(ask_for_json("reload")["map_hash"], content_hash(test::small_map()));
  write_config("[solve]\nno_such_key = 1\n");
  const auto refused = ask_for_json("reload");
  EXPECT_EQ(refused["code"], 78);
  EXPECT_THAT(refused["text"].get<std::string>(), HasSubstr("no_such_key"));
  write_config("");
  EXPECT_THAT(request("reload"), StartsWith("ok reloaded: /"));
}

TEST_F(DaemonRequestsTest, AReloadThatDoesNotEndIsNotWaitedFor) {
  std::atomic<bool> held{true};
  load_setup_ = [&](const std::filesystem::path& path) {
    while (held) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return load_setup(path);
  };
  start();
  const Descriptor client = ask("json reload");
  turn_for(seconds(9));
  EXPECT_EQ(answer_to(client), "");
  turn_for(seconds(2));
  EXPECT_THAT(answer_to(client), HasSubstr("\"code\":75"));
  held = false;
}

TEST_F(DaemonRequestsTest, AnIgnoredMarkerIsKeptInTheStateFolderAndAllowedAgain) {
  start();
  const int mapped = test::small_map().submaps.front().markers.front().id.number;
  const std::string id = std::to_string(mapped);
  EXPECT_EQ(ask_for_json("ignore " + id)["id"], mapped);
  EXPECT_EQ(ask_for_json("status")["ignored"][0]["id"], mapped);
  const auto is_written = [&](const char* text) {
    return turn_until([&] {
      return std::filesystem::exists(tmp_.path() / "quarantine.json") &&
             (tmp_.read("quarantine.json").find("IGNORED") != std::string::npos) ==
                 (std::string(text) == "IGNORED");
    });
  };
  EXPECT_TRUE(is_written("IGNORED"));
  reload();
  EXPECT_EQ(ask_for_json("status")["ignored"].size(), 1U);
  EXPECT_EQ(ask_for_json("allow " + id)["ok"], true);
  EXPECT_TRUE(is_written("nothing"));
  EXPECT_EQ(ask_for_json("allow " + id)["code"], 65);
  for (const char* wrong : {"-1", "100000000", "1-3", "tag36h11", "tag99h1:3", "one"}) {
    EXPECT_EQ(ask_for_json(std::string("ignore ") + wrong)["code"], 65) << wrong;
  }
}

TEST_F(DaemonRequestsTest, OnlyWhatIsInQuarantineIsReleased) {
  const MarkerId marker = test::small_map().submaps.front().markers.front().id;
  ASSERT_TRUE(write_quarantine(
      tmp_.path() / "quarantine.json",
      {content_hash(test::small_map()), {{marker, QuarantineState::moved, 1, 0.5}}}));
  start();
  const std::string id = std::to_string(marker.number);
  EXPECT_EQ(ask_for_json("release " + std::to_string(marker.number + 1))["code"], 65);
  EXPECT_EQ(ask_for_json("release " + id)["ok"], true);
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return alert("MOVED", false) != nullptr;
  }));
  EXPECT_TRUE(
      turn_until([&] { return !statuses_.empty() && statuses_.back().quarantined_markers == 0; }));
  EXPECT_EQ(ask_for_json("release " + id)["code"], 65);
}

TEST_F(DaemonRequestsTest, WithoutAMapCamerasAndRecordingsTellWhatTheySee) {
  tmp_.write("locd.toml",
             "[rig]\ncamchain = \"rig.yaml\"\n[lcm]\nurl = \"memq://\"\n"
             "[[camera]]\nname = \"cam0\"\ndriver = \"v4l2\"\ndevice = \"left\"\n"
             "[[camera]]\nname = \"cam1\"\ndriver = \"v4l2\"\ndevice = \"right\"\n"
             "[record]\nmarkers = \"markers.toml\"\nmin_free_bytes = 0\n");
  start();
  ASSERT_THAT(request("start"), StartsWith("ok "));
  ASSERT_TRUE(turn_until([&] {
    give_set();
    return !statuses_.empty() && statuses_.back().recorded_sets > 3;
  }));
  const auto status = ask_for_json("status");
  EXPECT_EQ(status["cameras"][0]["markers"], 0);
  EXPECT_THAT(status["verdict"].get<std::string>(), StartsWith("no marker was seen"));
  EXPECT_THAT(ask_for_json("stop")["verdict"].get<std::string>(), StartsWith("no marker was seen"));
}

TEST_F(DaemonRequestsTest, TheCalibrationIsTheRigFileInUse) {
  start();
  const auto answer = ask_for_json("calibration");
  EXPECT_EQ(answer["online"], false);
  EXPECT_THAT(answer["text"].get<std::string>(), HasSubstr("does not calibrate"));
  const auto rig = parse_camchain(answer["rig_yaml"].get<std::string>(), "answer");
  ASSERT_TRUE(rig) << rig.error().message;
  EXPECT_EQ(rig->rig.cameras.size(), 2U);
}

}  // namespace
}  // namespace waymark
