#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/bundle/reduced_problem.h"
#include "mapbuilder/import/survey.h"

namespace waymark {

/// How well one entry of the survey agrees with the map.
struct SurveyResidual {
  std::string entry;              ///< "24 bottom-left – 60 bottom-left"
  std::vector<MarkerId> markers;  ///< concerned
  bool point = false;             ///< else a distance
  SurveyUse use = SurveyUse::fit;
  bool mapped = false;    ///< all its markers are in this sub-map; else nothing below is said
  double measured_m = 0;  ///< the distance; 0 for a point
  double residual_m = 0;  ///< map − measured; of a point the length of the difference
  double sigma_m = 0;     ///< stated
};

/// What the fit entries can fix.
struct SurveyReach {
  bool scale = false;  ///< at least one distance, or points that tell one
  bool frame = false;  ///< ≥ 3 points not on a line, on ≥ 2 markers: all six freedoms of the world
};

/// world_from_marker, all in one world; nullopt: not placed, or in another.
using MarkerPoses = IndexedVector<MarkerIndex, std::optional<Rigid3>>;

/// Those of a component's markers.
[[nodiscard]] MarkerPoses poses_of(const Component& component, const Estimate& estimate);

/// Which of the survey's fit entries lie on markers of one world, and what they fix.
[[nodiscard]] SurveyReach reach_of(const Survey& survey, const Observations& observations,
                                   const Calibration& calibration,
                                   const MarkerPoses& world_from_marker);

/// The motion facility_from_world by the fit points; nullopt unless they reach the frame.
[[nodiscard]] std::optional<Rigid3> facility_from_world(const Survey& survey,
                                                        const Observations& observations,
                                                        const Calibration& calibration,
                                                        const MarkerPoses& world_from_marker);

/// Residuals of the fit entries on markers that take part in `problem`: points in the facility's
/// world, distances within any one world (`world_of_marker` as BundleScope has it). Entry −
/// prediction in stated sigmas.
[[nodiscard]] std::vector<std::unique_ptr<BundleFactor>> survey_factors(
    const Survey& survey, const Observations& observations, const Calibration& calibration,
    const ReducedProblem& problem, const IndexedVector<MarkerIndex, WorldIndex>& world_of_marker);

/// Prior of one size class: size / stated size = 1 ± `sigma`. `already` is the factor that the
/// observations' sizes hold by now.
[[nodiscard]] std::unique_ptr<BundleFactor> size_prior(const ReducedLayout& layout,
                                                       SizeClassIndex size_class, double already,
                                                       double sigma);

/// Prior of a camera's edge bias: 0 ± `sigma_px`. `already_px` is what the observations were moved
/// by.
[[nodiscard]] std::unique_ptr<BundleFactor> edge_bias_prior(const ReducedLayout& layout,
                                                            CameraIndex camera, double already_px,
                                                            double sigma_px);

/// One of a camera's intrinsics (in the order of IntrinsicsVector, variable) near a value.
[[nodiscard]] std::unique_ptr<BundleFactor> intrinsic_prior(const ReducedLayout& layout,
                                                            CameraIndex camera, int number,
                                                            double expected, double sigma);

/// Every entry against markers of one world; points are aligned to the facility frame first unless
/// the world is that frame already.
[[nodiscard]] std::vector<SurveyResidual> survey_residuals(const Survey& survey,
                                                           const Observations& observations,
                                                           const Calibration& calibration,
                                                           const MarkerPoses& world_from_marker,
                                                           bool world_is_facility);

}  // namespace waymark
