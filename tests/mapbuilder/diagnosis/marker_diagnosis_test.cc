#include "mapbuilder/diagnosis/marker_diagnosis.h"

#include <gtest/gtest.h>

#include "tests/support/expect_ranges.h"

namespace waymark {
namespace {

TEST(DiagnosisOptions, AreHeldToTheirRanges) {
  expect_ranges<OddPrintOptions>(
      {ranged("least_sigmas", &OddPrintOptions::least_sigmas, {3, 20}),
       ranged("least_size_deviation", &OddPrintOptions::least_size_deviation, {0.005, 0.2}),
       ranged("least_stretch", &OddPrintOptions::least_stretch, {0.005, 0.2}),
       ranged("least_views", &OddPrintOptions::least_views, {3, 50}),
       ranged("least_markers", &OddPrintOptions::least_markers, {3, 50})});
  expect_ranges<PlaceOptions>(
      {ranged("least_views", &PlaceOptions::least_views, {3, 50}),
       ranged("least_parallax_rad", &PlaceOptions::least_parallax_rad, {0.008, 0.5}),
       ranged("least_separation", &PlaceOptions::least_separation, {0.05, 2}),
       ranged("least_turn_rad", &PlaceOptions::least_turn_rad, {0.1, 1.5})});
  expect_ranges<HistoryOptions>(
      {ranged("least_print_distance", &HistoryOptions::least_print_distance, {0.7, 1}),
       ranged("least_found", &HistoryOptions::least_found, {0.02, 0.5}),
       ranged("most_by_chance", &HistoryOptions::most_by_chance, {1e-6, 0.05})});
  expect_ranges<WrongIdOptions>(
      {ranged("most_to_other", &WrongIdOptions::most_to_other, {0.05, 0.4}),
       ranged("least_to_own", &WrongIdOptions::least_to_own, {0.3, 2}),
       ranged("least_to_own_alone", &WrongIdOptions::least_to_own_alone, {0.5, 5}),
       ranged("least_others_alone", &WrongIdOptions::least_others_alone, {2, 10})});
  expect_ranges<PresenceOptions>(
      {ranged("most_by_chance", &PresenceOptions::most_by_chance, {1e-9, 0.01})});
}

TEST(DiagnosisOptions, NameTheJudgeWhoseFieldIsOutside) {
  DiagnosisOptions options;
  options.presence.most_by_chance = 1;
  EXPECT_EQ(options.check().error().message,
            "presence.most_by_chance is 1; it must be from 1e-09 to 0.01");
}

}  // namespace
}  // namespace waymark
