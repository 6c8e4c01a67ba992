#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/map/marker_map.h"
#include "mapbuilder/evaluate/ground_truth.h"
#include "mapbuilder/evaluate/pose_accuracy.h"
#include "mapbuilder/evaluate/trajectory.h"

namespace waymark {

/// A sub-map's markers against their truth.
struct MarkerEvaluation {
  std::size_t truth = 0;               ///< markers there are
  std::vector<MarkerId> found;         ///< mapped ones among them, by rising id
  std::vector<MarkerId> missing;       ///< the others
  std::optional<PoseAccuracy> errors;  ///< `each` as `found`; nullopt when nothing was found
};

/// A trajectory against its truth.
struct CameraEvaluation {
  std::size_t truth = 0;                ///< poses there are
  std::size_t found = 0;                ///< estimated ones with a true pose within 1 ms
  std::optional<PoseAccuracy> errors;   ///< aligned on the cameras themselves, as the paper does
  std::optional<PoseRmse> rmse_in_map;  ///< carried by the markers' alignment: what a vehicle gets
};

/// One sub-map against the truth, aligned alone.
struct SubMapEvaluation {
  std::optional<MarkerEvaluation> markers;  ///< nullopt without true markers
  std::optional<CameraEvaluation> cameras;  ///< nullopt without a trajectory or true poses
};

[[nodiscard]] MarkerEvaluation evaluate_markers(const SubMap& submap,
                                                const std::map<MarkerId, Rigid3>& truth);

/// `markers` (optional) gives the alignment for rmse_in_map.
[[nodiscard]] CameraEvaluation evaluate_cameras(const MatchedPoses& poses,
                                                const MarkerEvaluation* markers);

/// FORMATS' JSON, schema 1, with m and degrees to 9 decimals, and a new line at the end. Ids with
/// their family where `with_family`. `aligned_on` says centres or corners, positions or poses.
[[nodiscard]] std::string format_evaluation_json(const std::vector<SubMapEvaluation>& submaps,
                                                 bool with_family);

/// The same for people.
[[nodiscard]] std::string format_evaluation_text(const std::vector<SubMapEvaluation>& submaps,
                                                 bool with_family);

}  // namespace waymark
