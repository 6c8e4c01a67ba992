#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapbuilder/import/survey.h"
#include "mapbuilder/mapping/joint_problem.h"

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

/// Which of the survey's fit entries lie on posed markers, and what they fix.
[[nodiscard]] SurveyReach reach_of(const Survey& survey, const ObservationTable& table,
                                   const MapState& state);

/// The motion facility_from_world by the fit points; nullopt unless they reach the frame.
[[nodiscard]] std::optional<Rigid3> facility_from_world(const Survey& survey,
                                                        const ObservationTable& table,
                                                        const MapState& state);

/// Residuals of the fit entries on markers that take part in `problem`: distances always, points
/// only `with_points` (the world is the facility frame then). Entry − prediction in stated sigmas.
[[nodiscard]] std::vector<std::unique_ptr<KeptFactor>> survey_factors(const Survey& survey,
                                                                      const ObservationTable& table,
                                                                      const JointProblem& problem,
                                                                      bool with_points);

/// Prior of one size class: size / stated size = 1 ± `sigma`. `already` is the factor that the
/// observations' sizes hold by now.
[[nodiscard]] std::unique_ptr<KeptFactor> size_prior(const JointProblem& problem,
                                                     std::size_t size_class, double already,
                                                     double sigma);

/// Prior of a camera's edge bias: 0 ± `sigma_px`. `already_px` is what the observations were moved
/// by.
[[nodiscard]] std::unique_ptr<KeptFactor> edge_bias_prior(const JointProblem& problem,
                                                          std::size_t camera, double already_px,
                                                          double sigma_px);

/// Every entry against the state; points are aligned to the facility frame first unless the world
/// is that frame already.
[[nodiscard]] std::vector<SurveyResidual> survey_residuals(const Survey& survey,
                                                           const ObservationTable& table,
                                                           const MapState& state,
                                                           bool world_is_facility);

}  // namespace waymark
