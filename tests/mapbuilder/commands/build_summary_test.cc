#include "mapbuilder/commands/build_summary.h"

#include <gtest/gtest.h>

#include <sstream>

namespace waymark {
namespace {

TEST(BuildSummary, HasALinePerSubMap) {
  BuildResult result;
  result.submaps.resize(2);
  result.submaps[1].map.markers.resize(3);
  result.submaps[1].map.rms_px = 0.25;
  result.submaps[1].map.rms_all_px = 0.5;
  result.submaps[1].observations = 12;
  result.submaps[1].rejected = 1;
  result.submaps[1].model_sigma_px = 0.125;
  std::ostringstream out;
  print_summary(result, out);
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);
  EXPECT_NE(text.find("sub-map 1: 3 markers, 0 frame sets localized, 0 ambiguous; 12 observations, "
                      "1 rejected; RMS 0.2500 px over accepted, 0.5000 px over all; corner sigma "
                      "0.125 px"),
            std::string::npos)
      << text;
}

TEST(BuildSummary, SaysWhatIsConsideredAndWhereModesAreTooFew) {
  BuildResult result;
  result.submaps.resize(1);
  BuiltSubMap& submap = result.submaps[0];
  submap.scale = ScaleUncertainty{812e-6, {}};
  submap.model_sigma_px = 0.4;
  submap.noise_share = 0.25;
  submap.dropped_mean = 0.005;
  submap.dropped_worst = 0.017;
  std::ostringstream out;
  print_summary(result, out);
  EXPECT_NE(out.str().find("sub-map 0: scale ± 812 ppm; corner sigma without calibration's part "
                           "0.100 px; 16 modes leave out 0.5 % of the markers' variance, 1.7 % of "
                           "the worst's\n"),
            std::string::npos)
      << out.str();
  submap.dropped_worst = 0.03;
  std::ostringstream more;
  print_summary(result, more);
  EXPECT_NE(more.str().find("3 % of the worst's: more would be needed\n"), std::string::npos);
}

TEST(BuildSummary, OfTheSurveyMappedEntriesAreToldWithTheirUse) {
  BuildResult result;
  result.submaps.resize(1);
  SurveyResidual entry;
  entry.entry = "3 center";
  entry.mapped = true;
  entry.residual_m = -0.002;
  entry.sigma_m = 0.001;
  entry.use = SurveyUse::check;
  result.submaps[0].survey = {entry, entry, entry};
  result.submaps[0].survey[1].use = SurveyUse::left_out;
  result.submaps[0].survey[2].mapped = false;
  std::ostringstream out;
  print_survey(result, out);
  EXPECT_EQ(out.str(),
            "sub-map 0: survey check: 3 center: off by -2.00 mm (-2.0 sigma)\n"
            "sub-map 0: survey left out: 3 center: off by -2.00 mm (-2.0 sigma)\n");
}

}  // namespace
}  // namespace waymark
