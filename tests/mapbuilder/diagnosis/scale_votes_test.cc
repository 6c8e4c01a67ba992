#include "mapbuilder/diagnosis/scale_votes.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

ScaleWitness witness(ScaleSide side, double log_scale, double sigma = 0.001, double weight = 1) {
  return {side, log_scale, sigma, weight, 0};
}

TEST(ScaleVotes, MostVotesWinAndTheirMeanIsBySigma) {
  const ScaleWitness sizes = witness(ScaleSide::sizes, 0, 0.01);
  const ScaleWitness baselines = witness(ScaleSide::baselines, 0.2, 0.01);
  const ScaleWitness distance = witness(ScaleSide::distance, 0.21);
  const ScaleParty best = heaviest_of({sizes, baselines, distance});
  EXPECT_EQ(best.weight, 2);
  EXPECT_NEAR(best.log_scale, 0.21, 0.0002);
  EXPECT_TRUE(holds(best, distance));
  EXPECT_FALSE(holds(best, sizes));
  EXPECT_EQ(names_of(best.members), "the rig's baselines, 1 distance");
}

TEST(ScaleVotes, FiveSigmasOfBothAreTheBorder) {
  const ScaleWitness one = witness(ScaleSide::sizes, 0, 0.003);
  EXPECT_EQ(heaviest_of({one, witness(ScaleSide::points, 0.0249, 0.004)}).weight, 2);
  EXPECT_EQ(heaviest_of({one, witness(ScaleSide::points, 0.0251, 0.004)}).weight, 1);
}

TEST(ScaleVotes, NobodyHasNoVotes) { EXPECT_EQ(heaviest_of({}).weight, 0); }

}  // namespace
}  // namespace waymark
