#pragma once

#include "mapbuilder/bundle/bundle_problem.h"
#include "mapbuilder/bundle/noise_model.h"
#include "mapbuilder/bundle/outlier_gate.h"
#include "mapbuilder/growth/marker_placement.h"

namespace waymark {

/// Options of incremental growth.
struct GrowthOptions {
  RigPoseOptions rig_pose;     ///< its loss: the mapper's
  PlacementOptions placement;  ///< its loss: the mapper's
  /// A marker is placed at once when its runner-up is worse by this (sigmas²); below, only when
  /// nothing clearer is left to do. (0–1000) 20 as in RigPoseOptions.
  double placement_gap = 20.0;
  /// Rigs that see this many mapped markers place new ones first, then those that see fewer: a rig
  /// that hangs on one marker may stand wrong, and everything it places with it. (1–10)
  int firm_markers = 3;
  /// Views that place a marker, half of them the largest, half spread over the rest. (2–1000)
  int max_placement_views = 16;
  /// The joint adjustment runs whenever the map has grown by this factor. (1.05–10)
  double adjust_growth = 1.5;
  /// An unambiguous pose that costs at most this per observation (sigmas²) is not searched again:
  /// twice what Gaussian noise costs in eight residuals. (8–100)
  double explained_sigmas2 = 16.0;
  /// Growth ends where what has grown misses by a model sigma beyond this (px), for whoever would
  /// rather look for what all observations share that is wrong. (1–20) 20: never.
  double give_up_sigma_px = kLargestModelSigma;

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Options of the mapper, which begins and grows a map until it is at rest.
struct MapperOptions {
  NoiseModel noise;      ///< its model_sigma_px is the start; it is estimated from the residuals
  ObservationLoss loss;  ///< of Algorithms 1 and 2
  OutlierGateOptions gate;
  GrowthOptions growth;
  BundleSolver solver = BundleSolver::own;
  int max_passes = 8;  ///< (1–50) of adjust, reconsider, gate
  int threads = 0;     ///< (kThreads) 0 = all processors; changes no result of the own solver

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Options as algorithms take them: losses handed down, threads counted.
[[nodiscard]] MapperOptions effective(MapperOptions options);

}  // namespace waymark
