#include "mapbuilder/commands/build_summary.h"

#include <fmt/ostream.h>

#include "mapbuilder/bundle/sensitivity_modes.h"
#include "mapbuilder/commands/print_line.h"

namespace waymark {
namespace {

const char* name_of(SurveyUse use) {
  return use == SurveyUse::fit ? "fit" : use == SurveyUse::check ? "check" : "left out";
}

/// What the map's sigmas against the outside rest on.
void print_considered(std::size_t index, const BuiltSubMap& submap, std::ostream& out) {
  fmt::print(out,
             "sub-map {}: scale ± {:.0f} ppm; corner sigma without calibration's part {:.3f} px",
             index, 1e6 * submap.scale->sigma, submap.noise_share * submap.model_sigma_px);
  const bool too_few = submap.dropped_mean > kDroppedMean || submap.dropped_worst > kDroppedWorst;
  fmt::print(out,
             "; {} modes leave out {:.2g} % of the markers' variance, {:.2g} % of the worst's{}\n",
             kMapModes, 100 * submap.dropped_mean, 100 * submap.dropped_worst,
             too_few ? ": more would be needed" : "");
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
    if (submap.scale) print_considered(i, submap, out);
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
