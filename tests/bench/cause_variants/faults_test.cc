// A short form of the table of variants: one capture of each way in which each cause shows, built
// by the program's own code. bench_cause_variants builds twenty.
#include "bench/cause_variants/faults.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cctype>

#include "tests/support/temporary_folder.h"

namespace waymark::bench {
namespace {

std::string test_name(const Fault& fault) {
  std::string name;
  bool upper = true;
  for (const char c : std::string(name_of(fault.cause)) + " " + fault.name) {
    const bool letter = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (letter) name += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    upper = !letter;
  }
  return name;
}

class CauseVariants : public testing::TestWithParam<Fault> {};

TEST_P(CauseVariants, AreToldAndNobodyElseIsNamed) {
  const TemporaryFolder folder;
  const Variant variant = draw_variant(GetParam(), 0);
  const Said said = run_variant(variant, folder.path() / "variant");
  const Verdict verdict = judged(said, variant.truth);
  SCOPED_TRACE(variant.world().name + "\n" + said.output);
  EXPECT_FALSE(verdict.innocent_named);
  EXPECT_EQ(verdict.told, Verdict::Told::right);
  EXPECT_TRUE(verdict.exit_right) << said.exit_code;
  EXPECT_TRUE(verdict.value_right || !verdict.value_known) << variant.truth.value.value_or(0);
}

INSTANTIATE_TEST_SUITE_P(All, CauseVariants, testing::ValuesIn(all_faults()),
                         [](const auto& param) { return test_name(param.param); });

class SoundCaptures : public testing::TestWithParam<int> {};

TEST_P(SoundCaptures, AccuseNobody) {
  const TemporaryFolder folder;
  const Variant variant = draw_sound(GetParam());
  const Said said = run_variant(variant, folder.path() / "variant");
  const Verdict verdict = judged(said, variant.truth);
  SCOPED_TRACE(variant.world().name + "\n" + said.output);
  EXPECT_EQ(verdict.told, Verdict::Told::nothing);
  EXPECT_FALSE(verdict.innocent_named);
  EXPECT_TRUE(verdict.exit_right) << said.exit_code;
}

INSTANTIATE_TEST_SUITE_P(Twelve, SoundCaptures, testing::Range(0, 12));

TEST(CauseTable, HoldsEveryCauseOrSaysWhyNot) {
  std::set<Cause> known;
  for (const Fault& fault : all_faults()) known.insert(fault.cause);
  for (const NotShown& one : not_shown()) EXPECT_TRUE(known.insert(one.cause).second) << one.why;
  for (const CauseText& text : all_causes()) EXPECT_TRUE(known.contains(text.cause)) << text.name;
}

TEST(CauseTable, DrawsTheSameVariantEachTime) {
  const Fault fault = rig_faults().front();
  const auto once = seen_images(draw_variant(fault, 3).world());
  const auto again = seen_images(draw_variant(fault, 3).world());
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    ASSERT_EQ(once[i].detections.size(), again[i].detections.size());
    for (std::size_t d = 0; d < once[i].detections.size(); ++d) {
      EXPECT_EQ(once[i].detections[d].corners, again[i].detections[d].corners);
    }
  }
}

}  // namespace
}  // namespace waymark::bench
