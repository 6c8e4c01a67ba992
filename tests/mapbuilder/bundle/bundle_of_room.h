#pragma once

#include "mapbuilder/bundle/bundle_problem.h"
#include "tests/mapbuilder/observations/room_observations.h"

namespace waymark::test {

/// All of the room's observations, the first frame set constant, squared loss. The room must
/// outlive it.
inline BundleProblem bundle_of(const PreparedRoom& room) {
  BundleProblem problem;
  problem.prepared = &room.prepared;
  problem.observations = room.all();
  problem.constant.frame_sets = {FrameSetIndex(0)};
  problem.loss = {Loss::squared, 6.0};
  return problem;
}

}  // namespace waymark::test
