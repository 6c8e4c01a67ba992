#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/base/range.h"
#include "core/map/quarantine.h"
#include "locd/alert.h"
#include "locd/pose/map_index.h"
#include "locd/pose/pose_estimate.h"
#include "locd/pose/robust_pose.h"

namespace waymark {

/// When a marker is said not to hang where the map says.
struct MapWatchOptions {
  int min_other_markers = 3;    ///< inliers beside it, for a set to tell anything (2–20)
  double min_offset_m = 0.015;  ///< smaller moves are left to the robust loss (1 mm–1 m)
  double min_turn_rad = 0.05;   ///< likewise, 3° (0.002–0.5)
  /// Of the offset against its own and the map's covariance; 6 degrees of freedom, 1e-11 (20–500)
  double naming_chi2 = 65.0;
  double memory_sets = 60;  ///< small residuals are summed over so many (10–1000)
  int sets_elsewhere = 8;   ///< seen at one other place, for a marker far off (2–100)
  int sets_back = 40;       ///< seen in its place, to be used again (2–1000)
  int sets_unknown = 10;    ///< an id that the map lacks is no misreading any more (2–1000)
  /// One of those sets is forgotten in so long: misreadings that are rare never gather. (1 s–1 h)
  Stamp unknown_memory = std::chrono::seconds(10);
  /// Not seen for so long, a marker that the map lacks hangs there no more. (1 min–1 day)
  Stamp unknown_gone = std::chrono::hours(1);

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Watches over time whether the map's markers still hang where it says. Two kinds of evidence:
/// the small residuals that a marker leaves against the pose of all others, summed as an estimate
/// of its offset (leave-one-out: what it contributes to the pose is taken out exactly); and where
/// it is far off, the other place where it is seen again and again. A misread id, which is seen
/// anywhere, gathers neither. Markers found to have moved are quarantined in the index and named.
class MapWatch {
 public:
  /// The options are valid (checked).
  MapWatch(MapIndex& map, const RigPoseSolver& solver, const MapWatchOptions& options = {});

  /// One set: its observations with residuals, and its pose; observations of quarantined markers in
  /// a call of their own. However many cameras see a marker, the set counts once for it.
  /// `trusted_cameras`: whose residuals tell of markers rather than of the camera.
  void update(Stamp stamp, std::span<const SetObservation> observations,
              const PoseSolution& solution, CameraMask trusted_cameras, std::vector<Alert>& alerts);

  /// A detection that the map lacks, in a set with a pose.
  void note_unknown(Stamp stamp, const MarkerId& marker, std::vector<Alert>& alerts);

  /// To be called with every set: ends what was said of markers that were not seen for long.
  void forget_unknown(Stamp stamp, std::vector<Alert>& alerts);

  /// Since the last call of list_quarantine.
  [[nodiscard]] bool changed() const { return changed_; }
  /// By rising id; never more than most_quarantined().
  void list_quarantine(std::vector<QuarantinedMarker>& list);
  [[nodiscard]] std::size_t most_quarantined() const { return map_.size() + kMostUnknown; }
  void restore(std::span<const QuarantinedMarker> markers);

 private:
  /// What is known of one marker.
  struct Record {
    Matrix6d information = Matrix6d::Zero();  ///< of its offset, from small residuals
    Vector6d evidence = Vector6d::Zero();
    Rigid3 elsewhere;  ///< where it was seen instead
    int sets_elsewhere = 0;
    int sets_in_place = 0;  ///< lately; up to sets_back when quarantined
    double offset_m = 0;    ///< when it was named
    int seen = -1;          ///< index in seen_, while a set is looked at
  };
  /// A marker in the set that is looked at.
  struct Seen {
    std::size_t map_index = 0;
    int observations = 0;
    int fitting = 0;                          ///< of them, as the map says
    bool inlier = false;                      ///< of the set's pose, one of them
    const SetObservation* largest = nullptr;  ///< in the image
  };
  struct Unknown {
    MarkerId marker;
    int sets = 0;
    bool named = false;
    std::optional<Stamp> last;  ///< empty: not since a restart
  };

  void find_seen(std::span<const SetObservation> observations, CameraMask trusted_cameras);
  void count(const Seen& seen, const PoseSolution& solution);
  void judge(Stamp stamp, std::size_t map_index, std::vector<Alert>& alerts);
  void sum_residuals(const SetObservation& o, const PoseSolution& solution, Record& record) const;
  void look_elsewhere(const SetObservation& o, const PoseSolution& solution, Record& record) const;
  /// Whether the summed residuals tell of a move; its size.
  [[nodiscard]] bool drifted(const Record& record, const MapMarker& marker, Vector6d& offset) const;
  void begin_quarantine(Stamp stamp, std::size_t map_index, const Vector6d& offset,
                        std::vector<Alert>& alerts);
  void tell_unknown(Stamp stamp, const MarkerId& marker, bool raised, std::vector<Alert>& alerts);
  void end_quarantine(Stamp stamp, std::size_t map_index, std::vector<Alert>& alerts);

  MapIndex& map_;
  const RigPoseSolver& solver_;
  MapWatchOptions options_;
  /// Ids that the map lacks and that are remembered; of more, the ones not seen for longest go.
  static constexpr std::size_t kMostUnknown = 64;

  std::vector<Record> records_;
  std::vector<Seen> seen_;
  std::vector<Unknown> unknown_;
  bool changed_ = false;
};

}  // namespace waymark
