#include "locd/control/locdctl_command.h"

#include <gmock/gmock.h>

#include <sstream>

#include "tests/locd/control/fake_locd.h"

namespace waymark {
namespace {

using test::FakeLocd;
using testing::HasSubstr;
using testing::Not;

struct Told {
  Status status;
  std::string out;
  std::string notes;
};

Told run(LocdctlOptions options, const std::string& answer) {
  const FakeLocd locd(answer + "\n");
  options.control = locd.path();
  std::ostringstream out;
  std::ostringstream notes;
  const Status status = run_locdctl(options, out, notes);
  return {status, out.str(), notes.str()};
}

LocdctlOptions request(const char* word) {
  LocdctlOptions options;
  options.request = word;
  return options;
}

constexpr const char* kStatus =
    R"({"ok":true,"text":"recording to /r/1","status_text":"OK 97 % of 30/s, 14 markers, 3 mm",)"
    R"("recording":true,"recorded_sets":120,"recorded_bytes":2500000,"recorder_drops":3,)"
    R"("verdict":"97 markers, 1 seen once: pass 31 again","quarantined_markers":2,"map_markers":200,"cameras":[)"
    R"({"name":"cam0","state":"streaming","usable":true,"rate_hz":29.97,"markers":5,"frames":300,"dropped":0,"error":""},)"
    R"({"name":"cam1","state":"lost","usable":true,"rate_hz":0,"frames":10,"dropped":2,"error":"no such device"},)"
    R"({"name":"cam2","state":"streaming","usable":false,"rate_hz":30,"markers":0,"frames":300,"dropped":300,"error":""}],)"
    R"("ignored":[{"id":12,"family":"tag36h11"}]})";

TEST(Locdctl, TellsStatusInLines) {
  const Told told = run(request("status"), kStatus);
  ASSERT_TRUE(told.status) << told.status.error().message;
  EXPECT_EQ(told.out,
            "OK 97 % of 30/s, 14 markers, 3 mm\n"
            "cam0   streaming   30.0/s, 5 markers\n"
            "cam1   lost         0.0/s, 2 of 10 frames not used: no such device\n"
            "cam2   streaming   30.0/s, sees no marker, 300 of 300 frames not used, its images "
            "can't be used\n"
            "recording to /r/1: 120 frame sets, 2.5 MB, 3 that the disk did not take in time\n"
            "until now: 97 markers, 1 seen once: pass 31 again\n"
            "in quarantine: 2 of 200 markers\n"
            "ignored on request: tag36h11:12\n");
}

TEST(Locdctl, GivesJsonToPrograms) {
  LocdctlOptions options = request("status");
  options.json = true;
  const Told told = run(options, kStatus);
  ASSERT_TRUE(told.status);
  const auto json = nlohmann::json::parse(told.out);
  EXPECT_EQ(json["recorded_sets"], 120);
  EXPECT_FALSE(json.contains("ok"));
}

TEST(Locdctl, AnAnswerThatLacksMembersIsToldAsFarAsItGoes) {
  EXPECT_EQ(describe_status(nlohmann::ordered_json::object()), "just started\n\n");
  EXPECT_THAT(describe_status({{"text", 5}, {"cameras", {5, nullptr, {{"name", 7}}}}}),
              HasSubstr("just started"));
}

TEST(Locdctl, PrintsWhatWasDone) {
  const Told told = run(request("stop"), R"({"ok":true,"text":"/r/1","verdict":"97 markers"})");
  EXPECT_EQ(told.out, "/r/1\n");
  EXPECT_EQ(told.notes, "note: 97 markers\n");
}

TEST(Locdctl, WritesTheCalibrationWhereItIsAskedTo) {
  const TemporaryFolder folder;
  constexpr const char* kAnswer = R"({"ok":true,"text":"as it was read","rig_yaml":"cam0:\n"})";
  LocdctlOptions options = request("calibration");
  EXPECT_EQ(run(options, kAnswer).out, "cam0:\n");
  options.output = folder.path() / "rig.yaml";
  const Told told = run(options, kAnswer);
  EXPECT_EQ(told.out, "");
  EXPECT_EQ(told.notes, "note: as it was read\n");
  EXPECT_EQ(folder.read("rig.yaml"), "cam0:\n");
  options.output = folder.path() / "absent/rig.yaml";
  EXPECT_EQ(run(options, kAnswer).status.error().kind, ErrorKind::cant_create);
  EXPECT_EQ(run(options, R"({"ok":true,"text":""})").status.error().kind, ErrorKind::bad_data);
}

TEST(Locdctl, WhatLocdSaysOfItselfIsOneLine) {
  const Told told = run(request("stop"), R"({"ok":true,"text":"a\u001b[2J\nb"})");
  EXPECT_EQ(std::count(told.out.begin(), told.out.end(), '\n'), 1);
  EXPECT_THAT(told.out, Not(HasSubstr("\x1b")));
}

}  // namespace
}  // namespace waymark
