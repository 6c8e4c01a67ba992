#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/camera/camera_model.h"
#include "locd/camera_mask.h"
#include "locd/pose/set_observation.h"

namespace waymark {

/// What is added to the detector's covariance of a corner (px, per axis), by camera.
using NoiseSigmas = std::array<double, kMaxCameras>;

/// How sure one camera's corners really are, learnt without map, calibration of the rig or a pose
/// of it: each marker's own pose takes six of its eight numbers, and what the other two leave is
/// noise. Follows changes both ways; up to half of the markers may be wrong.
class CornerNoise {
 public:
  /// What one marker's own pose leaves.
  struct Left {
    double squared_px2 = 0;   ///< two freedoms
    double variance_px2 = 0;  ///< that it was whitened by, mean of the corners and axes
    double stated_px2 = 0;    ///< the detector's share of that
  };
  /// Markers that are remembered.
  static constexpr std::size_t kMemory = 256;
  static constexpr double kSmallest_px = 0.003;
  static constexpr double kLargest_px = 5.0;

  CornerNoise();
  /// Before anything was seen: several times the detector's own error, or what untreated corners
  /// have.
  void begin(bool stated);
  [[nodiscard]] bool begun() const { return sigma_px_ > 0; }
  void add(const Left& left);
  /// To be called after a set's markers were added.
  void update();

  [[nodiscard]] double sigma_px() const { return sigma_px_; }
  /// Whether the newest markers are as noisy as it says: until then residuals tell of nothing else.
  [[nodiscard]] bool settled() const { return settled_; }
  /// Whether corners are ten times noisier than they usually are (in sigma), or were and still are
  /// five times.
  [[nodiscard]] bool unusual() const { return unusual_; }
  /// The corners' noise of now and as it usually is, the detector's share included (px).
  [[nodiscard]] double total_px() const { return total_px_; }
  [[nodiscard]] double usual_px() const { return usual_px_; }

 private:
  /// Median of the newest markers' squared residuals over what is expected of them.
  [[nodiscard]] double ratio_of_newest(std::size_t count);
  /// Forgets all but the newest markers.
  void keep_newest(std::size_t count);
  void compare_with_usual();

  std::vector<Left> memory_;  ///< the newest last
  std::vector<double> ratios_;
  double sigma_px_ = 0;
  double total_px_ = 0;
  double usual_px_ = 0;
  bool unusual_ = false;
  bool settled_ = false;
  int updates_ = 0;
};

/// What an observation leaves of its marker's own pose, whitened by its present covariance; starts
/// from `cam_from_marker`, where that is near, else from its own. nullopt: it has none.
[[nodiscard]] std::optional<CornerNoise::Left> left_by_own_pose(
    const SetObservation& observation, const CameraModel& model,
    const std::optional<Rigid3>& cam_from_marker, double sigma_px);

}  // namespace waymark
