#pragma once

#include <optional>

#include "mapbuilder/build/map_builder.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// A map of every image on its own, whatever rig files, clocks and survey say.
struct MonoBuild {
  Observations observations;
  BuildResult result;

  /// What tells a camera of a capture (by its place among those given) apart from others: one that
  /// several captures have alike is one. nullopt where it has no image.
  [[nodiscard]] std::optional<RigIndex> rig_of(std::size_t capture, std::size_t camera) const;
};

/// Whether a mono build keeps the lenses that captures state, or refines them to convergence; of
/// lenses stated straight, whether they may bend.
enum class MonoLenses : char { kept, refined, refined_unbent };

/// nullopt where the captures make no observations, or no map.
[[nodiscard]] std::optional<MonoBuild> build_mono(const std::vector<DetectedCapture>& captures,
                                                  const BuildOptions& options,
                                                  MonoLenses lenses = MonoLenses::kept);

/// Images that tell as much as all: 60 of each camera, evenly spread, and those in which two
/// markers are seen together that have been so in fewer than three of them.
[[nodiscard]] std::vector<DetectedCapture> telling_images(std::vector<DetectedCapture> captures);

/// Images of one capture localized against the largest sub-map that a mono build's best estimate
/// makes, each on its own, by the lenses that the capture states.
struct LocalizedImages {
  Observations observations;
  SubMap map;
  std::vector<LocalizedFrameSet> trajectory;  ///< by rising index; unambiguous ones
  double model_sigma_px = 0;
};
[[nodiscard]] std::optional<LocalizedImages> localize_images(const DetectedCapture& capture,
                                                             const MonoBuild& mono,
                                                             const BuildOptions& options);

}  // namespace waymark
