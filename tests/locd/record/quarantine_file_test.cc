#include "locd/record/quarantine_file.h"

#include <gtest/gtest.h>

#include "drivers/monotonic_clock.h"
#include "tests/support/disk_double.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

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
  const QuarantineFile file(path);
  ASSERT_EQ(file.of_map("a").size(), 1U);
  EXPECT_EQ(file.of_map("a")[0].marker.number, 12);
  EXPECT_TRUE(file.of_map("b").empty());
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
  ASSERT_TRUE(file.take_failure());
  EXPECT_FALSE(file.take_failure());
  EXPECT_EQ(file.of_map("a").size(), 1U);
}

}  // namespace
}  // namespace waymark
