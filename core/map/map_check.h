#pragma once

#include <cstddef>

#include "core/base/error.h"
#include "core/map/marker_map.h"

namespace waymark {

/// Longest builder version and length of fingerprints, in bytes, that a map file holds.
inline constexpr std::size_t kMaxBuilderVersion = 32;
inline constexpr std::size_t kFingerprintLength = 16;

/// Whether a map is one that can be trusted as far as its numbers go; whatever its source (file,
/// JSON, our own mapper). bad_data, naming sub-map and marker, for: no markers; ids that repeat or
/// don't rise or lie outside their family; sizes outside (0, 100] m; numbers that are not finite;
/// a quaternion whose norm is off by more than 1e-6; a covariance that is neither unknown (NaN
/// throughout) nor within (1000 km)², not symmetric (to 1e-9 of its largest element) or not positive
/// semidefinite (to -1e-9 of it; within a map that considers more, and so holds it in floats,
/// 1e-6); modes without a metric covariance or beyond it (1e-5); parameters whose covariance is
/// none; RMS outside [0, 1e6] px; counts beyond 31 bits; sub-maps not by falling marker count; a
/// facility frame whose z is not up; a fingerprint that is not 16 hexadecimal digits (a rig's may be
/// empty); captures out of order; a builder version that is too long.
[[nodiscard]] Status check_map(const MarkerMap& map);

}  // namespace waymark
