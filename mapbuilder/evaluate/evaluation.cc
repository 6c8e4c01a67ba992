#include "mapbuilder/evaluate/evaluation.h"

#include <algorithm>

namespace waymark {

MarkerEvaluation evaluate_markers(const SubMap& submap, const std::map<MarkerId, Rigid3>& truth) {
  MarkerEvaluation evaluation;
  evaluation.truth = truth.size();
  std::vector<MarkerPair> pairs;
  for (const MapMarker& marker : submap.markers) {
    const auto known = truth.find(marker.id);
    if (known == truth.end()) continue;
    evaluation.found.push_back(marker.id);
    pairs.push_back({{marker.world_from_marker, known->second}, marker.size_m});
  }
  for (const auto& [id, pose] : truth) {
    if (!std::binary_search(evaluation.found.begin(), evaluation.found.end(), id)) {
      evaluation.missing.push_back(id);
    }
  }
  evaluation.errors = accuracy_of_markers(pairs);
  return evaluation;
}

CameraEvaluation evaluate_cameras(const MatchedPoses& poses, const MarkerEvaluation* markers) {
  CameraEvaluation evaluation;
  evaluation.truth = poses.truth;
  evaluation.found = poses.pairs.size();
  evaluation.errors = accuracy_of_cameras(poses.pairs);
  if (markers != nullptr && markers->errors && !poses.pairs.empty()) {
    evaluation.rmse_in_map =
        rmse_of(pose_errors(poses.pairs, markers->errors->truth_from_estimate));
  }
  return evaluation;
}

}  // namespace waymark
