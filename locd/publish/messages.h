#pragma once

#include <cstdint>
#include <string>
#include <waymark/alert_t.hpp>
#include <waymark/detections_t.hpp>
#include <waymark/pose_t.hpp>

#include "core/camera/rig.h"
#include "core/geometry/rigid3.h"
#include "locd/alert.h"
#include "locd/pose/pose_estimate.h"
#include "locd/publish/clock_offset.h"

namespace waymark {

/// What every message of a session says besides its own matter.
struct SessionFacts {
  std::string session_id;      ///< 16 hexadecimal digits
  std::string map_hash;        ///< 16 hexadecimal digits; empty without a map
  Rigid3 base_from_rig;        ///< the published pose is world_from_base
  bool world_z_is_up = false;  ///< as the map says: yaw has a meaning
  std::size_t cameras = 0;     ///< of the rig
  std::string rig;             ///< fingerprint of the rig file, 16 hexadecimal digits
};

/// What of the map in use messages and people need to know.
struct MapIdentity {
  std::string map_hash;           ///< 16 hexadecimal digits; empty without a map
  bool world_z_is_up = false;     ///< as the map says
  bool several_families = false;  ///< ids are written with their families
};

/// A session's name: 16 hexadecimal digits from the kernel's random numbers.
[[nodiscard]] std::string new_session_id();

/// A message with room for everything that it will ever hold, so that filling it allocates nothing.
[[nodiscard]] pose_t make_pose_message(const SessionFacts& session);
[[nodiscard]] detections_t make_detections_message(const SessionFacts& session);

/// Fills all but seq. `estimate` holds world_from_rig; the message, world_from_base, with its
/// covariance moved along. Where the estimate is LOST every number of the pose is NaN.
void fill_pose(const PoseEstimate& estimate, const SessionFacts& session, const ClockOffset& clock,
               Stamp published, pose_t& message);
void fill_detections(const PoseEstimate& estimate, const SessionFacts& session,
                     const ClockOffset& clock, detections_t& message);
/// `map`: the one that it was found with. The text may allocate: alerts are rare and are not
/// published by the solving thread.
void fill_alert(const Alert& alert, const Rig& rig, const MapIdentity& map,
                const SessionFacts& session, const ClockOffset& clock, alert_t& message);

/// world_from_base's covariance from world_from_rig's: the rotation's error, times the lever from
/// rig to base, moves the position.
[[nodiscard]] Matrix6d covariance_of_base(const Rigid3& world_from_rig, const Matrix6d& covariance,
                                          const Rigid3& base_from_rig);

/// Heading (deg, (−180, 180]) of the base's x axis about the world's z.
[[nodiscard]] double yaw_deg(const Rigid3& world_from_base);

}  // namespace waymark
