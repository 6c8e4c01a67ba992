#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "core/marker/marker_id.h"

namespace waymark {

/// A place on a marker: one of its corners (TL, TR, BR, BL: 0 … 3), or its centre.
struct MarkerPlace {
  MarkerId marker;
  std::optional<int> corner;  ///< nullopt: the centre
};

/// Whether an entry takes part in the adjustment, or only shows its residual: because the survey
/// says so, or because it was found to contradict the rest.
enum class SurveyUse { fit, check, left_out };

/// A place whose position in the facility frame was measured.
struct SurveyedPoint {
  MarkerPlace place;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();  ///< facility frame
  double sigma_m = 0;                                    ///< per axis
  SurveyUse use = SurveyUse::fit;
};

/// Two places whose distance was measured.
struct SurveyedDistance {
  MarkerPlace from;
  MarkerPlace to;
  double distance_m = 0;
  double sigma_m = 0;
  SurveyUse use = SurveyUse::fit;
};

/// What was measured on site.
struct Survey {
  std::vector<SurveyedPoint> points;
  std::vector<SurveyedDistance> distances;
  [[nodiscard]] bool empty() const { return points.empty() && distances.empty(); }
};

/// Reads survey.toml (FORMATS). `default_family` is that of ids
/// without one; nullopt where several meet. Errors: no_input or
/// bad_data naming file and line: unknown keys, corners or families, numbers that are not finite,
/// sigmas outside 10 µm … 10 m, a distance from a place to itself.
[[nodiscard]] Expected<Survey> read_survey(const std::filesystem::path& path,
                                           std::optional<Family> default_family);

/// The same from text; `name` stands for the path in messages.
[[nodiscard]] Expected<Survey> parse_survey(std::string_view text, const std::string& name,
                                            std::optional<Family> default_family);

/// "24 bottom-left", "12 center".
[[nodiscard]] std::string format_place(const MarkerPlace& place, bool with_family);

}  // namespace waymark
