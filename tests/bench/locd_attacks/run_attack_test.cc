// A short form of bench_locd_attacks: what holds today, row by row.
#include "bench/locd_attacks/run_attack.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace waymark::bench {
namespace {

constexpr int kSets = 200;

AttackFigures run(const std::string& name, const std::string& rig, std::uint64_t seed = 1,
                  int sets = kSets) {
  static const std::vector<Attack> kAll = all_attacks();
  const auto attack =
      std::find_if(kAll.begin(), kAll.end(), [&](const Attack& a) { return a.name == name; });
  return run_attack(*attack, {seed % 2 == 1 ? "room1" : "warehouse", rig, seed, sets});
}

double ok_share(const AttackFigures& figures) {
  return static_cast<double>(figures.ok) / figures.sets;
}

double nees_of_6(const AttackFigures& figures) { return figures.nees / 6 / figures.ok; }

void expect_no_innocents(const AttackFigures& figures) {
  EXPECT_EQ(figures.wrong, 0);
  EXPECT_EQ(figures.innocent_markers + figures.innocent_cameras, 0) << figures.alerts;
}

TEST(LocdAttacks, ACleanDriveIsOkAndNamesNobody) {
  for (const std::string rig : {"mono", "cg60", "cg120"}) {
    const AttackFigures figures = run("clean", rig);
    expect_no_innocents(figures);
    EXPECT_GE(ok_share(figures), 0.85) << rig;
  }
}

TEST(LocdAttacks, ACalibrationAsGoodAsTheyAreAccusesNobody) {
  for (const std::string rig : {"mono", "cg60", "cg120"}) {
    const AttackFigures figures = run("calibration 0.05 deg 1 mm 0.1 % 0.5 px k1 0.005", rig);
    expect_no_innocents(figures);
    EXPECT_GE(ok_share(figures), 0.85) << rig;
    EXPECT_LE(nees_of_6(figures), 4) << rig;
  }
}

TEST(LocdAttacks, WhatACalibrationErrsByIsLearntAndSigmasStayTrue) {
  constexpr std::uint64_t kAisles = 2;
  const AttackFigures figures =
      run("calibration 0.05 deg 1 mm 0.1 % 0.5 px k1 0.005", "cg120", kAisles, 400);
  expect_no_innocents(figures);
  EXPECT_GE(ok_share(figures), 0.95);
  EXPECT_LE(nees_of_6(figures), 2);
}

TEST(LocdAttacks, AReadOutThatNobodyStatedIsLearnt) {
  constexpr std::uint64_t kAisles = 2;
  const AttackFigures figures = run("read-out of 10 ms undeclared", "cg120", kAisles, 400);
  expect_no_innocents(figures);
  EXPECT_GE(ok_share(figures), 0.85);
  EXPECT_LE(nees_of_6(figures), 2);
}

TEST(LocdAttacks, ALateCameraIsNamedAndTheOthersGoOn) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const AttackFigures figures = run("one camera 20 ms late", "cg120", seed);
    expect_no_innocents(figures);
    ASSERT_EQ(figures.named_after.size(), 1U) << figures.alerts;
    EXPECT_LE(figures.named_after[0], 100);
    EXPECT_GE(ok_share(figures), 0.6) << reasons_of(figures);
  }
}

TEST(LocdAttacks, ASwapInARingIsNotTakenForAnotherOne) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const AttackFigures figures =
        run("two cameras swapped, right again at 600", "cg120", seed, 300);
    expect_no_innocents(figures);
    EXPECT_EQ(figures.named_after.size(), 1U) << figures.alerts;
  }
}

TEST(LocdAttacks, ACameraIsNamedHoweverManyMarkersWereSeenBefore) {
  constexpr std::uint64_t kAisles = 2;
  const AttackFigures figures = run("camera knocked by 1-2 deg at 100", "cg60", kAisles, 400);
  expect_no_innocents(figures);
  ASSERT_EQ(figures.named_after.size(), 1U) << figures.alerts;
  EXPECT_LE(figures.named_after[0], 100);
  EXPECT_GE(ok_share(figures), 0.7) << reasons_of(figures);
}

TEST(LocdAttacks, AMapByHandAccusesNobody) {
  const AttackFigures figures = run("map by hand, 5 mm", "cg60");
  expect_no_innocents(figures);
  EXPECT_GE(ok_share(figures), 0.85);
  EXPECT_LE(nees_of_6(figures), 1.3);
}

TEST(LocdAttacks, ALensThatIsOffIsNamedAndNoPoseIsWrong) {
  for (const std::string rig : {"mono", "cg60", "cg120"}) {
    const AttackFigures figures = run("f + 1 %", rig);
    expect_no_innocents(figures);
    EXPECT_EQ(figures.named_after.size(), 1U) << rig << figures.alerts;
  }
}

TEST(LocdAttacks, MarkersOnAPalletAreToldToRideAlong) {
  const AttackFigures figures = run("pallet, mapped where it stood", "cg60");
  expect_no_innocents(figures);
  ASSERT_EQ(figures.named_after.size(), 1U);
  EXPECT_LE(figures.named_after[0], 50);
  EXPECT_GE(ok_share(figures), 0.85);
}

TEST(LocdAttacks, AnotherFloorsMapIsToldAndNoMarkerIsAccused) {
  const AttackFigures figures = run("another floor's map", "cg120");
  expect_no_innocents(figures);
  EXPECT_EQ(figures.named_after.size(), 1U) << "within 200 sets";
  EXPECT_EQ(figures.ok, 0);
}

TEST(LocdAttacks, AParkedVehicleAccusesNobody) {
  expect_no_innocents(run("parked, k1 off by 0.02", "cg120"));
}

}  // namespace
}  // namespace waymark::bench
