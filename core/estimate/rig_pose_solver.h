#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/camera/rig.h"
#include "core/estimate/marker_observation.h"

namespace waymark {

/// An observation of a marker whose place in the world is known and fixed.
struct FixedMarkerObservation {
  const MarkerObservation* observation = nullptr;
  Rigid3 world_from_marker;
};

/// Where Algorithm 1 starts.
enum class RigPoseSeed {
  scored_solutions,  ///< both IPPE solutions of all observations, each scored on all of them
  best_own_fit,      ///< eq. 10: the better solution of the one observation that fits itself best
};

/// Options of Algorithm 1. Sigmas are those that the observations are whitened by.
struct RigPoseOptions {
  ObservationLoss loss;  ///< eq. 9's σ(·)
  /// Candidates are compared by k²·log(1 + s/k²), which grows for a marker that is far off without
  /// letting it decide alone. (5–100 sigmas)
  double score_scale_sigmas = 20.0;
  /// Optima are ranked by the same; or, where this is set (5–100 sigmas), by k²(1 − exp(−s/k²)),
  /// which counts every marker that is off alike, however far: two hypotheses that explain as many
  /// markers as each other are then ambiguous.
  std::optional<double> bounded_score_sigmas;
  RigPoseSeed seed = RigPoseSeed::scored_solutions;
  int max_seed_observations = 64;  ///< (1–1000) give candidates; of more, the largest in the image
  int max_refined = 4;             ///< (2–50) candidates that are optimized
  int max_iterations = 30;         ///< (1–200) of Levenberg–Marquardt
  /// A start that comes beside an optimum that is known is given up: quicker, and of two places
  /// less than `distinct` apart the first found is taken, not the lower.
  bool give_up_beside_known = false;
  /// The runner-up explains the data too when its score exceeds the best's by less (sigmas²): 20 is
  /// the 99.7 % quantile of χ² with 6 degrees of freedom. (0–1000)
  double ambiguity_gap = 20.0;
  /// Two solutions are distinct when they differ by more than this. (0.002–0.5 rad, 1 mm–1 m)
  double distinct_rad = 0.035;
  double distinct_m = 0.05;

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// What Algorithm 1 found.
struct RigPoseEstimate {
  PoseOptimum best;                      ///< world_from_rig
  std::optional<PoseOptimum> runner_up;  ///< the best distinct local optimum, if one was found
  bool ambiguous = false;                ///< the runner-up explains the data too
};

/// Algorithm 1: the pose of a rig from the observations of one frame set against fixed markers
/// (eq. 9). Seeded by both IPPE solutions of all observations of all cameras, each scored
/// on all observations, so that a flipped marker can't win (the paper's eq. 10, an option for
/// comparison, starts from the one marker that fits itself best and yields no runner-up). Holds its
/// working memory: one solver per thread, reused, which allocates nothing once it has seen as many
/// observations.
class RigPoseSolver {
 public:
  /// Keeps a reference to the rig's camera models; the rig must outlive the solver. The options are
  /// valid (checked).
  RigPoseSolver(const Rig& rig, const RigPoseOptions& options);

  /// For so many observations: with fewer it allocates nothing.
  void reserve(std::size_t observations);

  /// nullopt when no candidate exists (no observation has an IPPE solution and there is no prior)
  /// or nothing can be projected. `priors` (world_from_rig) are further candidates; they are always
  /// refined.
  [[nodiscard]] std::optional<RigPoseEstimate> solve(
      std::span<const FixedMarkerObservation> observations, std::span<const Rigid3> priors = {});

  /// Local optimum from one start; nullopt when no observation can be projected there.
  [[nodiscard]] std::optional<PoseOptimum> refine(
      std::span<const FixedMarkerObservation> observations, const Rigid3& start) const {
    return refine(observations, start, options_.loss);
  }
  /// The same by another loss, which is valid (checked).
  [[nodiscard]] std::optional<PoseOptimum> refine(
      std::span<const FixedMarkerObservation> observations, const Rigid3& start,
      const ObservationLoss& loss) const;

  /// What optima are ranked by, sigmas²: the misfit of all observations, each one's bounded.
  [[nodiscard]] double rank(std::span<const FixedMarkerObservation> observations,
                            const Rigid3& world_from_rig) const;

  /// cam_from_rig and model of a camera.
  [[nodiscard]] const Rigid3& cam_from_rig(std::size_t camera) const {
    return cam_from_rig_[camera];
  }
  [[nodiscard]] const CameraModel& model(std::size_t camera) const { return *models_[camera]; }
  /// Where an observation of this camera stands.
  [[nodiscard]] ObservationGeometry geometry(int camera, const Rigid3& world_from_rig,
                                             const Rigid3& world_from_marker) const {
    const auto index = static_cast<std::size_t>(camera);
    return {models_[index], cam_from_rig_[index], world_from_rig, world_from_marker};
  }

 private:
  struct Candidate {
    Rigid3 world_from_rig;
    double score = 0;       ///< sigmas², bounded growth
    std::size_t index = 0;  ///< of the candidate, or of the optimum
  };

  void collect_candidates(std::span<const FixedMarkerObservation> observations);
  /// Takes an observation's IPPE solution as a candidate, with its score on all of them.
  void add_candidate(std::span<const FixedMarkerObservation> observations,
                     const FixedMarkerObservation& fixed, const Rigid3& cam_from_marker);
  template <typename Bound>
  [[nodiscard]] double sum(std::span<const FixedMarkerObservation> observations,
                           const Rigid3& world_from_rig, const Bound& bound) const;
  [[nodiscard]] double score(std::span<const FixedMarkerObservation> observations,
                             const Rigid3& world_from_rig) const;
  [[nodiscard]] bool same(const Rigid3& a, const Rigid3& b) const;
  [[nodiscard]] bool beside_known(const Rigid3& world_from_rig) const;
  template <typename GivenUp>
  [[nodiscard]] std::optional<PoseOptimum> refine(
      std::span<const FixedMarkerObservation> observations, const Rigid3& start,
      const ObservationLoss& loss, const GivenUp& given_up) const;
  void keep_optimum(const PoseOptimum& optimum);

  RigPoseOptions options_;
  std::vector<const CameraModel*> models_;
  std::vector<Rigid3> cam_from_rig_;
  std::vector<std::pair<double, std::size_t>> by_size_;
  std::vector<Candidate> candidates_;
  std::vector<Rigid3> starts_;
  std::vector<PoseOptimum> optima_;
  std::vector<Candidate> ranked_;
};

}  // namespace waymark
