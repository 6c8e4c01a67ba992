#include "locd/pose/evidence.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/small_map.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

constexpr std::size_t kCameras = 2;

/// Sets whose observations are any linear functions of what may be wrong.
class Sets : public testing::Test {
 protected:
  [[nodiscard]] EvidenceRow row(std::size_t marker, std::size_t camera, std::uint64_t view) {
    const auto fill = [&](auto& matrix) {
      for (double& number : matrix.reshaped()) number = normal_(random_);
    };
    EvidenceRow row{marker, camera, 0, view, ErrorColumns::none(0)};
    fill(row.columns.by_pose);
    fill(row.columns.by_marker);
    fill(row.columns.by_camera);
    fill(row.columns.residual);
    return row;
  }

  CalibrationPrior prior_{test::ring_rig(kCameras), {}, test::small_map().submaps[0], false};
  Evidence evidence_{prior_, 100};
  Evidence::System system_;
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

TEST_F(Sets, AreNewUntilTheSameWasSeenThreeTimes) {
  const std::vector<EvidenceRow> rows{row(1, 0, 11), row(2, 1, 22)};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(evidence_.is_new(rows), i < 3) << i;
  const std::vector<EvidenceRow> half{row(1, 0, 11), row(3, 1, 33)};
  EXPECT_TRUE(evidence_.is_new(half));
}

TEST_F(Sets, SayNothingOfWhatTheirOwnPosesExplain) {
  std::vector<EvidenceRow> rows{row(1, 0, 1), row(2, 1, 2), row(3, 1, 3)};
  const Vector6d pose = Vector6d::Random();
  for (EvidenceRow& r : rows) r.columns.residual = r.columns.by_pose * pose;
  evidence_.add(rows);
  evidence_.sum(1, system_);
  EXPECT_LT(system_.evidence.norm(), 1e-5);
  EXPECT_GT(system_.information.norm(), 1);
  EXPECT_EQ(system_.sets, 1);
  EXPECT_EQ(evidence_.sets(), 1);
}

TEST_F(Sets, ThatAreOldGoBlockByBlock) {
  const int many = Evidence::kSetsPerBlock * (Evidence::kBlocks + 2);
  for (int i = 0; i < many; ++i) {
    evidence_.add(
        std::vector<EvidenceRow>{row(i < Evidence::kSetsPerBlock ? 1 : 2, 0, 1), row(3, 1, 3)});
  }
  evidence_.sum(1, system_);
  EXPECT_EQ(system_.sets, Evidence::kSetsPerBlock);
  evidence_.sum(4, system_);
  EXPECT_EQ(system_.sets, 4 * Evidence::kSetsPerBlock);
  evidence_.block(1, system_);
  EXPECT_EQ(system_.sets, Evidence::kSetsPerBlock);
  for (const std::size_t marker : system_.markers) EXPECT_NE(marker, 1U) << "its slot is free";
}

TEST_F(Sets, OfMoreMarkersThanAreAskedAboutTheFirstCount) {
  std::vector<EvidenceRow> rows;
  for (std::size_t m = 0; m < 2 * Evidence::kMostMarkers; ++m) rows.push_back(row(m, 0, m));
  evidence_.add(rows);
  evidence_.sum(1, system_);
  for (std::size_t slot = 0; slot < Evidence::kMostMarkers; ++slot) {
    EXPECT_EQ(system_.markers[slot], slot);
    EXPECT_EQ(system_.views[slot], 1);
  }
}

TEST_F(Sets, AreForgottenWhenTold) {
  evidence_.add(std::vector<EvidenceRow>{row(1, 0, 1), row(2, 1, 2)});
  evidence_.clear();
  evidence_.sum(4, system_);
  EXPECT_EQ(system_.sets, 0);
  EXPECT_EQ(system_.information.norm(), 0);
}

}  // namespace
}  // namespace waymark
