#include "mapbuilder/diagnosis/diagnosed_build.h"

#include "core/map/map_file.h"
#include "tests/mapbuilder/diagnosis/diagnosed_room.h"

namespace waymark::test {
namespace {

class DiagnosedBuildTest : public DiagnosedRoom {};

void state_size(SyntheticRoom& room, int id, double size_m) {
  auto entries = room.catalog.entries();
  entries.front().size_m_by_id[id] = size_m;
  room.catalog = MarkerCatalog(entries);
}

TEST_F(DiagnosedBuildTest, namesNobodyInASoundRoom) {
  build(noisy_room());
  expect_nobody();
}

TEST_F(DiagnosedBuildTest, namesNobodyInSoundMonoCaptures) {
  build({capture_of(noisy_room())}, {.mono = true, .threads = 1});
  expect_nobody();
}

TEST_F(DiagnosedBuildTest, aWrongSizeIsFittedAndTheRestUnharmed) {
  SyntheticRoom room = noisy_room();
  state_size(room, 7, 0.33);
  build(room);
  expect_only(Cause::size, 7);
  EXPECT_NEAR(figure("stated size"), 0.33, 1e-12);
  EXPECT_NEAR(figure("fitted size"), 0.30, 0.001);
  ASSERT_NE(mapped(7), nullptr);
  EXPECT_NEAR(mapped(7)->size_m, 0.30, 0.001);
  EXPECT_EQ(mapped(7)->stated_size_m, 0.33);
  EXPECT_LT(worst_distance_m(room, {}), 0.01);
}

TEST_F(DiagnosedBuildTest, aSizeWithinThePrintsToleranceIsNotNamed) {
  SyntheticRoom room = noisy_room();
  state_size(room, 7, 0.3 * 1.02);
  build(room);
  expect_nobody();
}

TEST_F(DiagnosedBuildTest, aRigFileThatDoesNotFitDoesNotBendTheFittedSize) {
  SyntheticRoom room = noisy_room();
  state_size(room, 7, 0.36);
  Vector6d off;
  off << 0.03, -0.02, 0.01, 0.01, 0.015, -0.01;
  Rigid3& rig_from_cam = room.rig.cameras[1].rig_from_cam;
  rig_from_cam = rig_from_cam.plus(off);
  build(room);
  expect_only(Cause::size, 7);
  EXPECT_NEAR(figure("fitted size"), 0.30, 0.003);
}

TEST_F(DiagnosedBuildTest, threadsLeaveNoTrace) {
  SyntheticRoom room = noisy_room();
  state_size(room, 7, 0.33);
  hang(room, 3, shifted(room.world_from_marker[3], 1.0, 0.2), 0.3, [](Stamp) { return true; });
  const auto built_by = [&](int threads) {
    const auto observations =
        make_observations({capture_of(room)}, {.mono = false, .threads = threads});
    EXPECT_TRUE(observations);
    BuildOptions options;
    options.threads = threads;
    return build_and_diagnose(*observations, options, {}, progress_);
  };
  const DiagnosedBuild one = built_by(1);
  const DiagnosedBuild three = built_by(3);
  ASSERT_EQ(one.findings.size(), three.findings.size());
  for (std::size_t i = 0; i < one.findings.size(); ++i) {
    EXPECT_EQ(one_line(one.findings[i]), one_line(three.findings[i]));
  }
  EXPECT_EQ(content_hash(one.result.map), content_hash(three.result.map));
}

}  // namespace
}  // namespace waymark::test
