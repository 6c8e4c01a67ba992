#include "locd/record/quarantine_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "drivers/monotonic_clock.h"
#include "tests/support/disk_double.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using testing::HasSubstr;

Quarantine quarantine_of(const std::string& map_hash, int marker) {
  return {map_hash, {{{Family::tag36h11, marker}, QuarantineState::moved, 1, 0.3}}};
}

Stamp soon() { return monotonic_now() + std::chrono::seconds(20); }

TEST(QuarantineFile, WhatIsWrittenIsReadAgainForItsMapOnly) {
  const TemporaryFolder tmp;
  const auto path = tmp.path() / "quarantine.json";
  {
    QuarantineFile file(path);
    EXPECT_TRUE(file.of_map("a").empty());
    file.write(quarantine_of("a", 12));
  }
  QuarantineFile file(path);
  ASSERT_EQ(file.of_map("a").size(), 1U);
  EXPECT_EQ(file.of_map("a")[0].marker.number, 12);
  EXPECT_TRUE(file.of_map("b").empty());
  EXPECT_TRUE(file.take_news().empty());
  EXPECT_EQ(file.trouble(), "");
}

TEST(QuarantineFile, ADiskThatStallsHoldsUpNobodyAndTheNewestIsKnown) {
  const TemporaryFolder tmp;
  const auto path = tmp.path() / "quarantine.json";
  test::DiskDouble disk;
  QuarantineFile file(path);
  disk.stall();
  file.write(quarantine_of("a", 12));
  ASSERT_TRUE(disk.holds_somebody(soon()));
  file.write(quarantine_of("a", 13));
  file.write(quarantine_of("a", 14));
  EXPECT_EQ(file.of_map("a")[0].marker.number, 14);
  EXPECT_FALSE(file.settle(monotonic_now()));
  disk.release();
  EXPECT_TRUE(file.settle(soon()));
  const auto read = read_quarantine(path);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->markers[0].marker.number, 14);
}

TEST(QuarantineFile, AFailureIsSaidOnceAndTheNewestStaysKnown) {
  QuarantineFile file("/nonexistent/quarantine.json");
  file.write(quarantine_of("a", 12));
  ASSERT_TRUE(file.settle(soon()));
  const auto news = file.take_news();
  ASSERT_EQ(news.size(), 1U);
  EXPECT_TRUE(news[0].wrong);
  ASSERT_TRUE(file.settle(soon()));  // tried again, with the same result
  EXPECT_TRUE(file.take_news().empty());
  EXPECT_EQ(file.trouble(), news[0].text);
  EXPECT_EQ(file.of_map("a").size(), 1U);
}

/// A folder that is absent when the quarantine is to be written, and then is not.
class AbsentFolder {
 public:
  [[nodiscard]] std::filesystem::path file() const { return tmp_.path() / "state/quarantine.json"; }
  void make() const { std::filesystem::create_directory(tmp_.path() / "state"); }
  [[nodiscard]] int marker_in_file() const {
    const auto read = read_quarantine(file());
    return read ? read->markers.at(0).marker.number : -1;
  }

 private:
  TemporaryFolder tmp_;
};

TEST(QuarantineFile, WhatFailedIsWrittenOnceTheDiskIsWell) {
  const AbsentFolder folder;
  QuarantineFile file(folder.file());
  file.write(quarantine_of("a", 12));
  ASSERT_TRUE(file.settle(soon()));
  EXPECT_NE(file.trouble(), "");
  folder.make();
  // Of itself, after a pause.
  const Stamp deadline = soon();
  while (file.trouble() != "" && monotonic_now() < deadline) std::this_thread::yield();
  EXPECT_EQ(folder.marker_in_file(), 12);
  const auto news = file.take_news();
  ASSERT_EQ(news.size(), 2U);
  EXPECT_FALSE(news[1].wrong);
  EXPECT_THAT(news[1].text, HasSubstr("written again"));
}

TEST(QuarantineFile, WhatFailedIsTriedOnceMoreAtTheEnd) {
  const AbsentFolder folder;
  {
    QuarantineFile file(folder.file());
    file.write(quarantine_of("a", 12));
    ASSERT_TRUE(file.settle(soon()));
    file.write(quarantine_of("a", 13));
    folder.make();
  }
  EXPECT_EQ(folder.marker_in_file(), 13);
}

TEST(QuarantineFile, WhatFailsAlsoAtTheEndHoldsNothingUp) {
  const AbsentFolder folder;
  QuarantineFile file(folder.file());
  file.write(quarantine_of("a", 12));
}

/// Files in place of quarantine.json that can't be used.
struct Unusable {
  const char* name;
  void (*make)(const std::filesystem::path& path);
};

void write_text(const std::filesystem::path& path, std::string_view text) {
  std::ofstream(path, std::ios::binary) << text;
}

class UnusableQuarantine : public testing::TestWithParam<Unusable> {};

TEST_P(UnusableQuarantine, IsSaidKeptBesideAndNeverOverwritten) {
  const TemporaryFolder tmp;
  const auto path = tmp.path() / "quarantine.json";
  GetParam().make(path);
  const auto before = std::filesystem::symlink_status(path);
  {
    QuarantineFile file(path);
    EXPECT_TRUE(file.of_map("a").empty());
    const auto news = file.take_news();
    ASSERT_EQ(news.size(), 1U);
    EXPECT_TRUE(news[0].wrong);
    EXPECT_THAT(news[0].text, HasSubstr("quarantine.json.damaged"));
    EXPECT_THAT(file.trouble(), HasSubstr("quarantine.json.damaged"));
    EXPECT_TRUE(file.of_map("a").empty());
    EXPECT_TRUE(file.take_news().empty());
    file.write(quarantine_of("a", 12));
  }
  const auto kept = std::filesystem::symlink_status(tmp.path() / "quarantine.json.damaged");
  EXPECT_EQ(kept.type(), before.type());
  EXPECT_EQ(read_quarantine(path)->markers.at(0).marker.number, 12);
  EXPECT_EQ(QuarantineFile(path).trouble(), "");
}

INSTANTIATE_TEST_SUITE_P(
    , UnusableQuarantine,
    testing::Values(Unusable{"cut_off", [](const auto& path) { write_text(path, "{\"map_ha"); }},
                    Unusable{"empty", [](const auto& path) { write_text(path, ""); }},
                    Unusable{"of_a_newer_locd",
                             [](const auto& path) {
                               write_text(path,
                                          "{\"map_hash\": \"a\", \"markers\": [{\"id\": 1, "
                                          "\"family\": \"tag36h11\", \"state\": \"RIDING\", "
                                          "\"since_utime\": 1, \"offset_m\": 0.5}]}");
                             }},
                    Unusable{"a_folder",
                             [](const auto& path) { std::filesystem::create_directory(path); }},
                    Unusable{"a_pipe", [](const auto& path) { ::mkfifo(path.c_str(), 0600); }},
                    Unusable{"a_link_to_itself",
                             [](const auto& path) {
                               std::filesystem::create_symlink("quarantine.json", path);
                             }}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(QuarantineFile, WhatWasSetAsideEarlierStays) {
  const TemporaryFolder tmp;
  const auto path = tmp.write("quarantine.json", "second");
  tmp.write("quarantine.json.damaged", "first");
  QuarantineFile file(path);
  EXPECT_TRUE(file.of_map("a").empty());
  EXPECT_EQ(tmp.read("quarantine.json.damaged"), "first");
  EXPECT_EQ(tmp.read("quarantine.json.damaged.2"), "second");
}

TEST(QuarantineFile, WhatWasDamagedMeanwhileIsNotOverwrittenEither) {
  const TemporaryFolder tmp;
  const auto path = tmp.path() / "quarantine.json";
  {
    QuarantineFile file(path);
    EXPECT_TRUE(file.of_map("a").empty());
    tmp.write("quarantine.json", "by hand");
    file.write(quarantine_of("a", 12));
    ASSERT_TRUE(file.settle(soon()));
    EXPECT_THAT(file.trouble(), HasSubstr("quarantine.json.damaged"));
  }
  EXPECT_EQ(tmp.read("quarantine.json.damaged"), "by hand");
}

}  // namespace
}  // namespace waymark
