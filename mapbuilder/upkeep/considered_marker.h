#pragma once

#include "core/map/marker_map.h"

namespace waymark {

/// What an updated marker, its covariance within the map known already, considers. No round
/// averages out what calibration and sizes may be wrong by: one that stood (`before`: as the old
/// map has it) keeps that map's modes; of one that is new or placed anew (`before` null) the
/// round's modes, of which the map's know nothing, are its own uncertainty, turned by
/// `old_from_round`. A marker that neither considers stays so.
void consider(const MapMarker* before, const Rigid3& old_from_round, MapMarker& marker);

}  // namespace waymark
