#pragma once

#include "core/geometry/rigid3.h"
#include "mapbuilder/bundle/bundle_factor.h"

namespace waymark {

/// What an earlier map knows of a marker, as a residual of six rows: Σ^(−½) (pose ⊟ where it
/// stood). Eigenvalues of Σ below (10 µm)² and (10⁻⁵ rad)² count as that: a covariance whose gauge
/// takes directions out is singular, and no paper hangs more surely. An unknown Σ counts as
/// 0.1 m and 0.1 rad, as locd takes it.
class MarkerPrior : public BundleFactor {
 public:
  /// `block`: the marker's in the reduced system.
  MarkerPrior(int block, const Rigid3& world_from_marker, const Matrix6d& covariance);

  [[nodiscard]] std::vector<int> blocks() const override { return {block_}; }
  [[nodiscard]] FactorLinearization linearize(const BundleVariables& at) const override;

 private:
  int block_;
  Rigid3 world_from_marker_;
  Matrix6d whitening_;
};

}  // namespace waymark
