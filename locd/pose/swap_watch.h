#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "core/base/range.h"
#include "core/camera/rig.h"
#include "locd/alert.h"
#include "locd/pose/map_index.h"
#include "locd/pose/pose_estimate.h"
#include "locd/pose/robust_pose.h"

namespace waymark {

/// When two cameras are said to be in each other's place.
struct SwapWatchOptions {
  double trusted_share = 0.7;    ///< of a camera's markers that must fit, on average (0.5–1)
  int swap_sets = 6;             ///< that only a swap explains, to name it (2–1000)
  int right_sets = 20;           ///< in which both agree with the others, to end it (2–1000)
  double coherent_share = 0.75;  ///< inliers of a set in which nothing is wrong (0.5–1)

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Watches whether two cameras are in each other's place: where most markers of a set are outliers,
/// exchanging two cameras is tried as an explanation. Ends when they agree with the others again.
class SwapWatch {
 public:
  /// The options are valid (checked).
  SwapWatch(const Rig& rig, const MapIndex& map, const SwapWatchOptions& options = {});

  /// One set: its pose, its observations with residuals there.
  void update(Stamp stamp, const Rigid3& world_from_rig,
              std::span<const SetObservation> observations, std::vector<Alert>& alerts);

  /// Cameras whose outliers are due to their markers, not to the camera itself.
  [[nodiscard]] CameraMask trusted() const;
  /// Cameras that were named and have not been right since.
  [[nodiscard]] CameraMask suspects() const;

 private:
  struct Record {
    double inlier_share = 0.5;  ///< running mean over sets
    int markers = 0;            ///< of the set
    int inliers = 0;            ///< of them
    bool named = false;
    std::size_t partner = 0;
    int right_sets = 0;  ///< since it was named, in which it agrees with another
  };
  struct Turned {  ///< how the rig stood
    Stamp stamp{0};
    Eigen::Quaterniond world_from_rig = Eigen::Quaterniond::Identity();
  };
  struct CameraPair {
    std::size_t a = 0;
    std::size_t b = 0;
    int sets = 0;                ///< that only their swap explains
    std::optional<Turned> last;  ///< in the last of them
  };
  void look_for_swaps_that_ended(Stamp stamp, bool coherent, std::vector<Alert>& alerts);
  [[nodiscard]] bool may_be_swapped(const CameraPair& pair) const;
  void look_for_swap(Stamp stamp, std::span<const SetObservation> observations,
                     std::vector<Alert>& alerts);
  /// The rig's rotation when they are; nullopt: that does not explain the set.
  [[nodiscard]] std::optional<Eigen::Quaterniond> explained_by_swap(
      std::span<const SetObservation> observations, std::size_t a, std::size_t b);
  /// Whether the rig may have turned so far since it was last known how it stood.
  [[nodiscard]] bool can_have_turned(const CameraPair& pair, const Turned& now) const;
  void tell(Stamp stamp, std::size_t camera, bool raised, std::vector<Alert>& alerts);

  const MapIndex& map_;
  SwapWatchOptions options_;
  std::size_t cameras_;
  RigPoseSolver solver_;
  std::array<Record, kMaxCameras> records_;
  std::vector<CameraPair> pairs_;
  std::optional<Turned> last_coherent_;
  std::size_t asked_pair_ = 0;  ///< the next set is asked about it
  std::vector<MarkerObservation> scratch_;
  std::vector<FixedMarkerObservation> fixed_;
};

}  // namespace waymark
