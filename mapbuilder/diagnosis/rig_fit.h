#pragma once

#include <optional>
#include <vector>

#include "mapbuilder/diagnosis/rig_agreement.h"

namespace waymark {

/// A row of judged instants [first, last).
struct InstantRange {
  std::size_t first = 0;
  std::size_t last = 0;
};

/// Whose place on the rig is fitted, whatever is stated.
class FreeCameras {
 public:
  static FreeCameras none() { return FreeCameras(-1); }
  static FreeCameras one(std::size_t camera) { return FreeCameras(static_cast<int>(camera)); }
  /// All but the first, which the others stand against.
  static FreeCameras all() { return FreeCameras(kAll); }
  [[nodiscard]] bool holds(std::size_t camera) const {
    return which_ == kAll ? camera > 0 : static_cast<int>(camera) == which_;
  }

 private:
  static constexpr int kAll = -2;
  explicit FreeCameras(int which) : which_(which) {}
  int which_;
};

/// Fits rigs to the tracks of their cameras, over instants that two cameras share: at most 160,
/// evenly spread.
class RigFit {
 public:
  RigFit(const CameraTracks& tracks, const Extrinsics& stated);

  /// Factor on the places' standard deviations: the noise that the best explanation leaves.
  void set_noise_scale(double scale) { noise_scale_ = scale; }
  [[nodiscard]] double noise_scale() const { return noise_scale_; }

  [[nodiscard]] const Extrinsics& stated() const { return stated_; }
  [[nodiscard]] std::size_t cameras() const { return stated_.size(); }
  [[nodiscard]] const std::vector<std::size_t>& judged() const { return judged_; }
  [[nodiscard]] InstantRange all() const { return {0, judged_.size()}; }

  /// Σ of the bounded misfits (sigmas²).
  [[nodiscard]] double cost(const CameraTracks& tracks, const Extrinsics& rig,
                            InstantRange range) const;
  /// The same per judged instant.
  [[nodiscard]] std::vector<double> costs(const CameraTracks& tracks, const Extrinsics& rig) const;
  /// What leaving the stated calibration costs (sigmas²).
  [[nodiscard]] double prior_cost(const Extrinsics& rig, const Extrinsics& start,
                                  FreeCameras free) const;
  /// How far a place on the rig is from another, in sigmas of the stated calibration.
  [[nodiscard]] double stated_sigmas(const Rigid3& place, const Rigid3& from) const;

  /// The rig near `start` that fits best, each camera that is not free held by the calibration's
  /// sigmas. Rig poses and cameras in turn.
  [[nodiscard]] Extrinsics fit(const CameraTracks& tracks, const Extrinsics& start,
                               FreeCameras free, InstantRange range) const;

  /// The place of a camera on the rig that most instants agree on, given where the other cameras
  /// put the rig as stated. nullopt where they never tell.
  [[nodiscard]] std::optional<Rigid3> place_by_others(const CameraTracks& tracks,
                                                      std::size_t camera, InstantRange range) const;

 private:
  void add_place(const TrackedPlace& place, const Rigid3& world_from_rig,
                 const Rigid3& rig_from_cam, Matrix6d& hessian, Vector6d& gradient) const;

  Extrinsics stated_;
  Vector6d prior_;                   ///< information of a stated place
  std::vector<std::size_t> judged_;  ///< instants
  double noise_scale_ = 1.0;
};

}  // namespace waymark
