#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/camera/rig.h"
#include "core/capture/detection.h"
#include "core/detect/expected_marker.h"
#include "locd/camera_mask.h"
#include "locd/pose/map_index.h"
#include "locd/pose/motion_filter.h"

namespace waymark {

/// Where markers are expected in a set's images, so that the rest need not be searched: those of
/// the map that a camera sees from where the rig is predicted, as far around as the prediction may
/// be off, and whatever else was seen in the camera's last image. By turns each camera's image is
/// searched as a whole, one of kTurns: what nobody expects is found within as many sets. Allocates
/// nothing after it was made.
class ExpectedWindows {
 public:
  /// Of so many images a camera's, one is searched as a whole.
  static constexpr int kTurns = 8;

  /// Copies what it needs of the map. The rig must outlive it.
  ExpectedWindows(const Rig& rig, const MapIndex& map);

  /// For the next set. nullopt: nothing is predicted, so that all images are searched as a whole.
  void predict(const std::optional<MotionPrediction>& prediction);

  /// What was found in the camera's image, expected or not.
  void remember(std::size_t camera, std::span<const Detection> detections);

  /// Where to look in each camera's image; empty: everywhere.
  [[nodiscard]] std::span<const std::vector<ImageWindow>> by_camera() const { return windows_; }

 private:
  struct Place {
    Rigid3 world_from_marker;
    Eigen::Vector3d normal;  ///< towards who sees it
    double size_m = 0;
  };
  void predict_camera(std::size_t camera, const MotionPrediction& prediction);
  void add_expected(const RigCamera& camera, const Rigid3& cam_from_world, const Place& place,
                    const MotionPrediction& prediction, std::vector<ImageWindow>& windows) const;
  void add_seen(std::size_t camera);

  const Rig& rig_;
  std::vector<Place> places_;
  int sets_ = 0;
  std::array<std::vector<ImageWindow>, kMaxCameras> windows_;
  std::array<std::vector<ExpectedMarker>, kMaxCameras> seen_;
};

}  // namespace waymark
