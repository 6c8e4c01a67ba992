#pragma once

#include <vector>

#include "mapbuilder/growth/joint_build.h"

namespace waymark {

/// A build as it was at some moment: what an attempt that fails must put back. The build must
/// outlive it.
class BuildSnapshot {
 public:
  explicit BuildSnapshot(JointBuild& build);

  /// Once.
  void restore();

 private:
  struct Part {
    NoiseModel noise;
    bool settled = false;
  };

  JointBuild& build_;
  ObservationTable table_;
  MapState state_;
  AdjustmentScope scope_;
  std::vector<Part> parts_;
};

}  // namespace waymark
