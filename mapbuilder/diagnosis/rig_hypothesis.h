#pragma once

#include <memory>

#include "core/camera/rig.h"
#include "mapbuilder/diagnosis/rig_explanation.h"
#include "mapbuilder/diagnosis/rig_fit.h"

namespace waymark {

/// One way to explain the tracks, with what it costs.
struct RigHypothesis {
  RigExplanation explanation;
  std::shared_ptr<const CameraTracks> tracks;  ///< as they would be without a fault of time
  Extrinsics rig;                              ///< from `since` on, or throughout
  Extrinsics rig_before;                       ///< before `since`
  std::size_t since = 0;                       ///< instant
  int numbers = 0;                             ///< that it frees
  double cost = 0;                             ///< sigmas²
  double price = 0;     ///< 2 ln of how much less sure its tracks are than those seen
  bool listed = false;  ///< one of few ways to write a file wrongly: no number is fitted
};

/// What hypotheses are made of and judged by.
class RigCase {
 public:
  RigCase(const CameraTracks& tracks, const Rig& rig, const RigFit& fit)
      : tracks_(std::make_shared<const CameraTracks>(tracks)),
        rig_(rig),
        fit_(fit),
        stated_cost_(fit.cost(tracks, fit.stated(), fit.all())) {}

  [[nodiscard]] const CameraTracks& tracks() const { return *tracks_; }
  [[nodiscard]] const RigFit& fit() const { return fit_; }
  [[nodiscard]] const Extrinsics& stated() const { return fit_.stated(); }
  [[nodiscard]] std::size_t cameras() const { return fit_.cameras(); }
  [[nodiscard]] const std::string& name(std::size_t camera) const {
    return tracks_->cameras[camera];
  }
  [[nodiscard]] const CameraModel& stated_lens(std::size_t camera) const {
    return rig_.cameras[camera].model;
  }
  /// By which the camera's places were told.
  [[nodiscard]] const CameraModel& lens_of_places(std::size_t camera) const {
    return tracks_->lenses.empty() ? stated_lens(camera) : tracks_->lenses[camera];
  }
  [[nodiscard]] std::vector<std::size_t> every_camera() const;
  [[nodiscard]] std::vector<std::size_t> all_but_first() const;
  [[nodiscard]] std::string names_but(std::size_t camera) const;

  /// A hypothesis about the tracks as they were seen.
  [[nodiscard]] RigHypothesis hypothesis() const;
  /// Fits what the calibration leaves open, or `free` cameras' places, near `start`, unless the
  /// hypothesis is no better than the stated rig before that.
  void evaluate(RigHypothesis& h, const Extrinsics& start,
                FreeCameras free = FreeCameras::none()) const;
  /// The stated rig with what its calibration leaves open.
  [[nodiscard]] RigHypothesis as_stated() const;
  /// The noise that a hypothesis leaves, as a factor on the stated one; by the median, so that
  /// instants that it does not explain have no say.
  [[nodiscard]] double noise_left(const RigHypothesis& h) const;

 private:
  void fit_open(RigHypothesis& h, const Extrinsics& start, FreeCameras free) const;

  std::shared_ptr<const CameraTracks> tracks_;
  const Rig& rig_;
  const RigFit& fit_;
  double stated_cost_;  ///< nothing fitted
};

}  // namespace waymark
