#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/diagnosis/judged_survey.h"
#include "mapbuilder/diagnosis/scale_votes.h"

namespace waymark {

/// Heights of one plan, and spots of markers, are the same within so many sigmas.
inline constexpr double kSameSpotSigmas = 5.0;
/// What sizes are printed to, as the adjustment has it (share of the size, one sigma).
inline const double kPrintSigma = BundleScope{}.size_sigma;

/// A surveyed spot of a marker as the images have it.
struct MappedSpot {
  const MapMarker* marker = nullptr;
  Eigen::Vector3d x_in_marker = Eigen::Vector3d::Zero();  ///< m
  double sigma_m = 0;                                     ///< per axis

  [[nodiscard]] Eigen::Vector3d x_in_world() const {
    return marker->world_from_marker * x_in_marker;
  }
};

/// nullopt where the map lacks the marker.
[[nodiscard]] std::optional<MappedSpot> spot_on(const SubMap& map, const MarkerPlace& place);

/// The survey's points on one sub-map.
struct SurveyPointsOfMap {
  std::vector<std::size_t> entries;   ///< indices of the survey's points
  std::optional<ScaleWitness> scale;  ///< what they say of it, where they agree with each other
};

/// Holds the fit points on a sub-map that was built without them against where the images have
/// their markers (agreement_of): left-handed ones and those that do not fit at all are left out
/// together, exchanged ones and single ones that are off alone, those at another corner are put
/// there; a z that is not up by walls or cameras is told. Three points at least, not on a line;
/// else nothing is said.
[[nodiscard]] SurveyPointsOfMap judge_survey_points(const BuiltSubMap& submap,
                                                    const BuildResult& result,
                                                    const Observations& observations,
                                                    JudgedSurvey& judged);

}  // namespace waymark
