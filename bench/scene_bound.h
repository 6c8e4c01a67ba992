#pragma once

#include <cstddef>
#include <vector>

#include "bench/corner_accuracy.h"
#include "bench/scene_covariance.h"
#include "bench/scene_trial.h"
#include "core/base/error.h"

namespace waymark::bench {

/// What a trial's map rests on, at the truth: its markers, the rigs of its trajectory, and the
/// observations between them.
struct TrueScene {
  SceneGeometry geometry;           ///< whitening: for 1 px
  std::vector<CornerPair> corners;  ///< as geometry.observations
  std::size_t misread = 0;          ///< observations farther off than kMisread_px, left out
};

/// A corner farther than this from its truth is not that corner.
inline constexpr double kMisread_px = 5.0;

/// The capture and the trial must outlive it. bad_data where a truth is absent.
[[nodiscard]] Expected<TrueScene> true_scene(const SceneCapture& capture, const SceneTrial& trial);

/// The Cramér–Rao bound for corners known to `sigma_px` per axis.
[[nodiscard]] Expected<SceneCovariance> bound_at_truth(const TrueScene& scene, double sigma_px);

/// The joint covariance of the finished map, of which it stores the markers' blocks, for the
/// whitening that it was built with.
[[nodiscard]] Expected<SceneCovariance> joint_covariance(const SceneTrial& trial);

/// What was possible with a capture's corners.
struct CornerVerdict {
  std::size_t observations = 0;
  std::size_t misread = 0;
  CornerAccuracy corners;
  SceneRmse bound;       ///< Cramér–Rao, for the corners' sigma
  SceneRmse by_bias;     ///< what the mean edge bias alone does to a least-squares map
  SceneRmse by_corners;  ///< what all corner errors as they are do to one that weighs all alike
};

[[nodiscard]] Expected<CornerVerdict> judge_corners(const SceneCapture& capture,
                                                    const SceneTrial& trial);

}  // namespace waymark::bench
