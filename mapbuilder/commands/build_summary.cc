#include "mapbuilder/commands/build_summary.h"

#include <fmt/ostream.h>

#include "mapbuilder/commands/print_line.h"

namespace waymark {
namespace {

const char* name_of(SurveyUse use) {
  return use == SurveyUse::fit ? "fit" : use == SurveyUse::check ? "check" : "left out";
}

}  // namespace

void print_summary(const BuildResult& result, std::ostream& out) {
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    const BuiltSubMap& submap = result.submaps[i];
    fmt::print(out,
               "sub-map {}: {} markers, {} frame sets localized, {} ambiguous; {} observations, "
               "{} rejected; RMS {:.4f} px over accepted, {:.4f} px over all; corner sigma "
               "{:.3f} px\n",
               i, submap.map.markers.size(), submap.trajectory.size(), submap.ambiguous.size(),
               submap.observations, submap.rejected, submap.map.rms_px, submap.map.rms_all_px,
               submap.model_sigma_px);
  }
}

void print_survey(const BuildResult& result, std::ostream& out) {
  for (std::size_t i = 0; i < result.submaps.size(); ++i) {
    for (const SurveyResidual& entry : result.submaps[i].survey) {
      if (!entry.mapped) continue;
      print_line(out, "sub-map {}: survey {}: {}: off by {:+.2f} mm ({:.1f} sigma)", i,
                 name_of(entry.use), entry.entry, entry.residual_m * 1e3,
                 entry.residual_m / entry.sigma_m);
    }
  }
}

}  // namespace waymark
