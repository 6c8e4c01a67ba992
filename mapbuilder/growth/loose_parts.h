#pragma once

#include <vector>

#include "mapbuilder/growth/joint_build.h"

namespace waymark {

/// A part of a map that hangs on the rest by the accepted observations of one marker, or by none,
/// with the place that the rejected ones between both agree on.
struct LoosePart {
  Component part;
  int hinge = -1;                  ///< the marker it hangs on; −1: none
  Rigid3 new_from_old;             ///< world from world, for all its poses
  std::vector<std::size_t> links;  ///< rejected observations that fit there; table indices, rising
  std::size_t markers = 0;         ///< different ones among them; two at least
};

/// The parts that other observations would rather have elsewhere, most markers first. One marker is
/// weak evidence: an id that exists twice, or is read wrongly, hangs a part of the building where
/// it is not, and growth can't see that before the part meets the rest. The rest is what holds
/// `anchor`, a frame set.
[[nodiscard]] std::vector<LoosePart> find_loose_parts(const ObservationTable& table,
                                                      const std::vector<std::size_t>& observations,
                                                      int anchor, const MapState& state);

/// Hangs loose parts of a settled build of one component where most markers agree and settles
/// again, as long as fewer markers contradict the map afterwards and its noise has not grown; else
/// all is as before.
void rehang_loose_parts(JointBuild& build);

}  // namespace waymark
