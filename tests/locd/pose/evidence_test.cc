#include "locd/pose/evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/support/small_map.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

constexpr std::size_t kCameras = 2;

/// Sets whose observations are any linear functions of what may be wrong.
class Sets : public testing::Test {
 protected:
  [[nodiscard]] EvidenceRow row(std::size_t marker, std::size_t camera) {
    const auto fill = [&](auto& matrix) {
      for (double& number : matrix.reshaped()) number = normal_(random_);
    };
    EvidenceRow row{marker, camera, 0, ErrorColumns::none(0)};
    fill(row.columns.by_pose);
    fill(row.columns.by_marker);
    fill(row.columns.by_camera);
    fill(row.columns.residual);
    return row;
  }

  void add(const std::vector<EvidenceRow>& rows) { evidence_.add(Rigid3(), rows); }

  CalibrationPrior prior_{test::ring_rig(kCameras), {}, test::small_map().submaps[0], false};
  Evidence evidence_{prior_};
  Evidence::System system_;
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

TEST_F(Sets, AreNewWhereTheRigHasMovedOrTurned) {
  const double distance_m = 4;
  EXPECT_TRUE(evidence_.is_new(Rigid3(), distance_m)) << "nothing was taken yet";
  add({row(1, 0), row(2, 1)});
  EXPECT_FALSE(evidence_.is_new(Rigid3(), distance_m)) << "it stands";
  const auto moved = [](double x_m, double turned_rad) {
    return Rigid3{so3_exp({0, 0, turned_rad}), {x_m, 0, 0}};
  };
  EXPECT_FALSE(evidence_.is_new(moved(0.07, 0), distance_m));
  EXPECT_TRUE(evidence_.is_new(moved(0.09, 0), distance_m));
  EXPECT_TRUE(evidence_.is_new(moved(0.07, 0), 3.2)) << "what is near is seen from elsewhere";
  EXPECT_FALSE(evidence_.is_new(moved(0, 0.019), distance_m));
  EXPECT_TRUE(evidence_.is_new(moved(0, 0.021), distance_m));
  evidence_.clear();
  EXPECT_TRUE(evidence_.is_new(Rigid3(), distance_m));
}

TEST_F(Sets, TellWhichCamerasShowAMarkerAndCountItOnce) {
  add({row(1, 0), row(1, 1), row(2, 1)});
  evidence_.sum(1, system_);
  ASSERT_EQ(system_.markers, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(system_.seen_by, (std::vector<CameraMask>{0b11, 0b10}));
  EXPECT_EQ(system_.views, (std::vector<int>{1, 1}));
}

TEST_F(Sets, OfNewMarkersAlwaysCountHoweverManyCameBefore) {
  for (std::size_t m = 0; m < 90; m += 3) {
    add({row(m, 0), row(m + 1, 1), row(m + 2, 1)});
    evidence_.sum(1, system_);
    for (std::size_t seen = m; seen < m + 3; ++seen) {
      EXPECT_NE(std::find(system_.markers.begin(), system_.markers.end(), seen),
                system_.markers.end())
          << seen;
    }
  }
  EXPECT_EQ(evidence_.sets(), 30);
}

TEST_F(Sets, ComeAgainWhereOneBlockIsFullOfOtherMarkers) {
  std::vector<EvidenceRow> many;
  for (std::size_t m = 0; m < Evidence::kMostMarkers; ++m) many.push_back(row(m, 0));
  add(many);
  const std::size_t late = 90;
  for (int i = 0; i < 3; ++i) add({row(late, 0), row(late + 1, 1)});
  EXPECT_GE(evidence_.sets(), 3);
}

TEST_F(Sets, SayNothingOfWhatTheirOwnPosesExplain) {
  std::vector<EvidenceRow> rows{row(1, 0), row(2, 1), row(3, 1)};
  const Vector6d pose = Vector6d::Random();
  for (EvidenceRow& r : rows) r.columns.residual = r.columns.by_pose * pose;
  add(rows);
  evidence_.sum(1, system_);
  EXPECT_LT(system_.evidence.norm(), 1e-5);
  EXPECT_GT(system_.information.norm(), 1);
  EXPECT_EQ(system_.sets, 1);
  EXPECT_EQ(evidence_.sets(), 1);
}

TEST_F(Sets, ThatAreOldGoBlockByBlock) {
  const int many = Evidence::kSetsPerBlock * (Evidence::kBlocks + 2);
  for (int i = 0; i < many; ++i) {
    add({row(i < Evidence::kSetsPerBlock ? 1 : 2, 0), row(3, 1)});
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
  for (std::size_t m = 0; m < 2 * Evidence::kMostMarkers; ++m) rows.push_back(row(m, 0));
  add(rows);
  evidence_.sum(1, system_);
  for (std::size_t slot = 0; slot < Evidence::kMostMarkers; ++slot) {
    EXPECT_EQ(system_.markers[slot], slot);
    EXPECT_EQ(system_.views[slot], 1);
  }
}

TEST_F(Sets, AreForgottenWhenTold) {
  add({row(1, 0), row(2, 1)});
  evidence_.clear();
  evidence_.sum(4, system_);
  EXPECT_EQ(system_.sets, 0);
  EXPECT_EQ(system_.information.norm(), 0);
}

}  // namespace
}  // namespace waymark
