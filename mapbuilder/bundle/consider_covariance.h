#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "core/map/marker_map.h"
#include "mapbuilder/bundle/consider_problem.h"

namespace waymark {

/// How sure a map's scale is, one standard deviation each, as shares.
struct ScaleUncertainty {
  struct Part {
    std::string_view of;  ///< "edges", "sizes", "focal lengths", "places of cameras", …
    double sigma = 0;
  };
  double sigma = 0;         ///< of all together
  std::vector<Part> parts;  ///< what each kind of parameter alone makes of it, the largest first
};

/// How sure a map is of its markers: by the corners' noise, and by calibration and sizes that may
/// be wrong in the same way in every image. World: the estimate's, in the gauge of MarkerInverse.
struct ConsideredMap {
  struct Marker {
    Matrix6d within;        ///< W: noise, and what another round of the same rig would not repeat
    Matrix6d metric;        ///< C: against the outside
    ModeSensitivity modes;  ///< T
  };
  std::vector<MarkerIndex> markers;  ///< rising
  std::vector<Marker> of_marker;
  ConsiderParameters parameters;  ///< with the covariance that the map leaves them
  std::vector<Rig> rigs;          ///< that the parameters are numbers of
  Eigen::MatrixXd cross;          ///< K = Cov(e, z): a row a parameter, kMapModes columns
  ScaleUncertainty scale;
  /// What the corners' noise is of what whitening takes for it (sigmas): residuals as they stand
  /// hold the calibration, too.
  double noise_share = 1;
  double dropped_mean = 0;   ///< of markers' variance, by modes that were not kept
  double dropped_worst = 0;  ///< of the worst marker's
};

/// Of the problem's accepted observations at the estimate, its optimum:
///
///     S = −Γ N⁻¹ M,  C = s² Γ N⁻¹ Γᵀ + S P Sᵀ,  T = [S L V | noise],  W = s² noise + ¼ ΔS P ΔSᵀ
///
/// (ERRORS 2; docs/algorithm.md): N, M the reduced normal equations, P = L Lᵀ the parameters'
/// covariance, for what was estimated that of the estimate; s² what one joint step (poses, markers
/// and parameters free) leaves of the residuals; V the leading modes, the columns left over the
/// leading directions of noise; ΔS between even and odd frame sets. nullopt where the markers are
/// not determined against each other, as MarkerInverse says. The same bits whatever the threads.
[[nodiscard]] std::optional<ConsideredMap> considered_map(const BundleProblem& problem,
                                                          const Estimate& estimate, int threads);

}  // namespace waymark
