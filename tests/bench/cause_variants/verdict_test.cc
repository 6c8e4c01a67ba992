#include <gtest/gtest.h>

#include "bench/cause_variants/variant.h"

namespace waymark::bench {
namespace {

Said::Line line(Severity severity, Cause cause) {
  Said::Line one;
  one.severity = severity;
  one.cause = cause;
  return one;
}

Truth late_cam1() {
  Truth truth;
  truth.causes = {Cause::clock};
  truth.cameras = {"cam1"};
  truth.value = 20.0;
  truth.within = 0.5;
  truth.exits = {65};
  return truth;
}

TEST(CauseVerdict, TheFirstAccusationCounts) {
  Said said;
  said.exit_code = 65;
  said.findings = {line(Severity::warning, Cause::few_views), line(Severity::error, Cause::clock),
                   line(Severity::warning, Cause::intrinsics)};
  EXPECT_EQ(judged(said, late_cam1()).told, Verdict::Told::right);
  std::swap(said.findings[1], said.findings[2]);
  EXPECT_EQ(judged(said, late_cam1()).told, Verdict::Told::wrong);
  said.findings.resize(1);
  EXPECT_EQ(judged(said, late_cam1()).told, Verdict::Told::nothing);
  EXPECT_TRUE(judged(said, late_cam1()).exit_right);
}

TEST(CauseVerdict, WhoIsNoPartOfItIsInnocent) {
  Said said;
  said.findings = {line(Severity::error, Cause::clock)};
  said.findings.front().cameras = {"cam1"};
  EXPECT_FALSE(judged(said, late_cam1()).innocent_named);
  said.findings.front().cameras = {"cam1", "cam2"};
  EXPECT_TRUE(judged(said, late_cam1()).innocent_named);
  said.findings.front().cameras = {};
  said.findings.front().markers = {"7"};
  EXPECT_TRUE(judged(said, late_cam1()).innocent_named);
  said.findings.front().severity = Severity::note;
  EXPECT_FALSE(judged(said, late_cam1()).innocent_named);
}

TEST(CauseVerdict, ValuesHoldWithinTheirBoundOrFourOfTheirSigmas) {
  Said said;
  said.findings = {line(Severity::error, Cause::clock)};
  const auto right = [&](double value, double sigma) {
    said.findings.front().value = value;
    said.findings.front().sigma = sigma;
    return judged(said, late_cam1()).value_right;
  };
  EXPECT_TRUE(right(20.4, 0.01));
  EXPECT_FALSE(right(20.6, 0.01));
  EXPECT_TRUE(right(21.0, 0.3));
  EXPECT_FALSE(right(-20, 0.3));
}

}  // namespace
}  // namespace waymark::bench
