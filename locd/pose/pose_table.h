#pragma once

#include <string>

#include "locd/pose/pose_estimate.h"

namespace waymark {

/// Pose estimates as CSV: set_ns,stamp_ns,status,reasons,x,y,z,qx,qy,qz,qw, the covariance's upper
/// triangle row by row c00…c55, v0…v5, cameras_in_set,cameras_used,markers_seen,markers_used,
/// observations_used,outliers,rms_px,max_skew_us. Stamps are moved back by `shift`.
[[nodiscard]] std::string pose_table_head();
void append_pose_table_row(const PoseEstimate& estimate, Stamp shift, std::string& text);

}  // namespace waymark
