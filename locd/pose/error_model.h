#pragma once

#include <array>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/camera/rig.h"
#include "locd/alert.h"
#include "locd/pose/calibration_filter.h"
#include "locd/pose/evidence.h"
#include "locd/pose/explanations.h"
#include "locd/pose/map_index.h"
#include "locd/pose/map_watch.h"
#include "locd/pose/noise_watch.h"
#include "locd/pose/robust_pose.h"

namespace waymark {

/// When something that explains what was seen is named.
struct ErrorModelOptions {
  double gain = 12;         ///< log likelihood gained by it, after paying for its freedom (5–100)
  double lead = 6;          ///< of that, over the next explanation (2–50)
  double over_gain = -3;    ///< with what is known, on newer sets alone: it is over (−20–0)
  double chi2 = 65;         ///< of the fault against its covariance (20–500)
  double marker_m = 0.015;  ///< smaller moves of markers name nobody (1 mm–1 m)
  double marker_rad = 0.05;    ///< likewise (0.002–0.5)
  double camera_m = 0.020;     ///< smaller displacements of cameras are calibration's (1 mm–1 m)
  double camera_rad = 0.0052;  ///< likewise, 0.3° (0.001–0.2)
  int sets_per_look = 8;       ///< that count, between judgements (1–100)
  int fewest_views = 3;        ///< new ones of a marker that is named (2–100)
  bool learns_calibration = true;

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// The one judge of what may be wrong: corners' noise, each camera's place, lens, clock and
/// read-out, each marker's place. Says how sure everything is before a set is solved, gathers
/// evidence over sets in which the vehicle moved, and lets all explanations compete: the one that
/// explains most per parameter, clearly, is named; else nobody is. A verdict is taken back when
/// newer sets speak against it or another explanation does better. What calibrations err by within
/// what is stated is learnt. Counts in sets, knows no clock.
class ErrorModel {
 public:
  /// The options are valid (checked). Rig, map and `markers`, which keeps who is quarantined, must
  /// outlive it. `prior`: how sure calibration, sizes and map are before anything was seen.
  ErrorModel(const Rig& rig, const MapIndex& map, MapWatch& markers, const CalibrationPrior& prior,
             const ErrorModelOptions& options = {});

  /// Corners' noise before anything was seen.
  void begin(bool covariances_stated);
  [[nodiscard]] bool begun() const { return noise_.begun(); }
  /// What to solve the next set with.
  [[nodiscard]] const KnownErrors& known() const { return known_; }

  /// One set's corners: learns their noise. `solution` may be null: noise needs no pose.
  void learn_noise(Stamp stamp, std::span<const SetObservation> observations,
                   const PoseSolution* solution, const RigPoseSolver& solver,
                   std::vector<Alert>& alerts);
  /// One set with its pose: all observations of mapped markers, used or not.
  void update(Stamp stamp, std::span<const SetObservation> observations,
              const PoseSolution& solution, const RobustPose& robust, std::vector<Alert>& alerts);

  /// A set is not told of, and what the rig did until the next is no motion.
  void interrupt() { waiting_.there = false; }

  /// Forgets what was gathered: something was there that no explanation is made for.
  void forget_evidence();

  /// Ends what was said of cameras, for something else is wrong with them.
  void end_verdicts(Stamp stamp, CameraMask cameras, std::vector<Alert>& alerts);

  /// Cameras that were named and are so still: they take no part where the others suffice.
  [[nodiscard]] CameraMask suspects() const;
  /// Something is wrong, and what it is can't be told yet.
  [[nodiscard]] bool undecided() const { return undecided_ != 0; }

 private:
  struct Verdict {  ///< on a camera
    Explanation what;
    CalibrationVector fault;
    Alert alert;
  };
  /// A set that waits for the next one, which tells how fast the rig was.
  struct Waiting {
    Stamp stamp{0};
    std::vector<SetObservation> observations;
    PoseSolution solution;
    std::optional<std::pair<Stamp, Rigid3>> before;  ///< the set before it
    bool there = false;
  };
  /// How fast the rig was at a set: over both neighbours, for clocks and read-outs show in that.
  struct Motion {
    Vector6d velocity;
    Vector6d unsure;  ///< what it may differ by: half of its change from one neighbour to the other
  };
  [[nodiscard]] static Motion motion_of(const Waiting& set, Stamp next,
                                        const Rigid3& next_world_from_rig);
  void gather(const Waiting& set, const Motion& motion, const RobustPose& robust,
              std::vector<Alert>& alerts);
  /// Columns of an observation; where its marker or camera is known to be elsewhere, at what is
  /// nearer to what is seen, so that they are linear.
  [[nodiscard]] std::optional<ErrorColumns> columns_of(const SetObservation& o,
                                                       ObservationGeometry geometry,
                                                       const Vector6d& velocity) const;
  void add_evidence(const Rigid3& world_from_rig);
  void make_rows(const Waiting& set, const Motion& motion, const RobustPose& robust);
  /// Whether a block of sets on its own speaks rather for another explanation, or for none.
  [[nodiscard]] bool contradicted_by_a_block(const Evidence& evidence, const Explanation& what);
  [[nodiscard]] bool contradicted_by_block(const Evidence& evidence, int age,
                                           const Explanation& what);
  /// Whether what suspects see is kept apart. One camera alone takes part all the same.
  [[nodiscard]] bool suspects_are_apart() const {
    return !verdicts_.empty() && rig_.cameras.size() > 1;
  }
  /// What says whether verdicts hold.
  [[nodiscard]] const Evidence& evidence_of_verdicts() const {
    return suspects_are_apart() ? of_suspects_ : evidence_;
  }
  /// A question to the explanations. Its answer takes some sets: no set shall take much longer than
  /// others.
  struct Question {
    int blocks = 0;                    ///< of evidence
    std::optional<Explanation> asked;  ///< a verdict, as if it had not been given
  };
  /// Whether there was a block to be learnt from.
  bool learn_calibration(Stamp stamp);
  void ask();
  [[nodiscard]] bool ask_of_a_verdict();
  void answer(Stamp stamp, std::vector<Alert>& alerts);
  void judge_explanations(Stamp stamp, int blocks, std::vector<Alert>& alerts);
  void judge_verdict(Stamp stamp, const Explanation& asked, std::vector<Alert>& alerts);
  void name_camera(Stamp stamp, const Score& score, std::vector<Alert>& alerts);
  [[nodiscard]] bool nameable(const Score& score) const;
  void name(Stamp stamp, const Score& score, std::vector<Alert>& alerts);
  void take_back(Stamp stamp, const Explanation& what, std::vector<Alert>& alerts);
  void believe();
  /// Takes the quarantined among the system's markers for moved.
  void believe_quarantine();

  const Rig& rig_;
  const MapIndex& map_;
  MapWatch& markers_;
  ErrorModelOptions options_;
  CalibrationPrior prior_;  ///< as the calibration states
  KnownErrors known_;
  NoiseWatch noise_;
  Evidence
      evidence_;  ///< without what suspects see: it is explained, and may change with the motion
  Evidence of_suspects_;  ///< with it, for the question whether they are so still
  Explanations explanations_;
  CalibrationFilter filter_;
  long learnt_block_ = 0;  ///< the last that the filter was offered
  Evidence::System system_;
  std::vector<EvidenceRow> rows_;
  double distance_m_ = 0;  ///< to their markers, mean
  std::vector<Verdict> verdicts_;
  std::vector<Explanation> believed_;
  unsigned undecided_ = 0;  ///< by bits: windows of evidence
  Waiting waiting_;
  long forgotten_ = 0;  ///< sets that were gathered and are no more
  int looks_ = 0;
  int looks_back_ = 0;
  bool look_due_ = false;
  bool back_due_ = false;             ///< a verdict is to be asked again
  std::optional<Question> question_;  ///< that is being answered
};

}  // namespace waymark
