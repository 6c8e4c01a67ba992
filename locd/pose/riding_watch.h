#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/estimate/rig_pose_solver.h"
#include "locd/pose/map_index.h"
#include "locd/pose/set_observation.h"

namespace waymark {

/// Finds markers that move along with the vehicle (a pallet's, the vehicle's own): seen from the
/// rig they stay where they are while others pass by. Needs no pose of the rig, which such markers
/// may have taken with them.
class RidingWatch {
 public:
  static constexpr double kPassed_m = 0.5;  ///< seen from the rig: a marker that passed by
  static constexpr double kStill_m = 0.05;  ///< one that stayed; and a share of its distance
  static constexpr double kStillShare = 0.03;
  /// What a vehicle carries is nearer; from farther away a marker that hangs ahead seems to stay,
  /// for its place is known to no better than others pass by.
  static constexpr double kFarthest_m = 6;
  static constexpr int kPassing = 3;     ///< different ones that passed by meanwhile
  static constexpr int kStillSets = 15;  ///< in which it stayed

  /// Map and solver must outlive it.
  RidingWatch(const MapIndex& map, const RigPoseSolver& solver);

  /// One set's observations of mapped markers. The markers that are found to ride with it, by map
  /// index: valid until the next call. Each is told once until it passes by itself.
  [[nodiscard]] std::span<const std::size_t> look(std::span<const SetObservation> observations);

 private:
  struct Record {
    Eigen::Vector3d at_in_rig = Eigen::Vector3d::Zero();
    long since = -1;  ///< set from which on it is there; −1: never seen
    long last = 0;    ///< set in which it was seen last
    int still = 0;    ///< sets in which it was there
    bool told = false;
  };
  struct Passed {
    std::size_t map_index = 0;
    long since = -1;  ///< set from which on it moved
  };
  void look_at(const SetObservation& observation);
  [[nodiscard]] int passed_since(long set) const;

  const MapIndex& map_;
  const RigPoseSolver& solver_;
  std::vector<Record> records_;
  std::array<Passed, 32> passed_;
  std::size_t next_passed_ = 0;
  long sets_ = 0;
  std::vector<std::size_t> riding_;
};

}  // namespace waymark
