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
  int min_other_markers = 3;  ///< inliers beside it, for a set to tell anything (2–20)
  int sets_elsewhere = 8;     ///< seen at one other place, for a marker far off (2–100)
  int sets_back = 40;     ///< seen in its place as exactly as others, to be used again (2–1000)
  int sets_unknown = 10;  ///< an id that the map lacks is no misreading any more (2–1000)
  /// One of those sets is forgotten in so long: misreadings that are rare never gather. (1 s–1 h)
  Stamp unknown_memory = std::chrono::seconds(10);
  /// Not seen for so long, a marker that the map lacks hangs there no more. (1 min–1 day)
  Stamp unknown_gone = std::chrono::hours(1);

  /// usage, naming the first field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// Keeps which of the map's markers are not where it says, and finds those that are far off: where
/// one fits nothing, the other place where it is seen again and again from new views. A misread id,
/// which is seen anywhere, gathers none. What is nearer the error model finds. Also names markers
/// that the map lacks.
class MapWatch {
 public:
  /// The options are valid (checked).
  MapWatch(MapIndex& map, const RigPoseSolver& solver, const MapWatchOptions& options = {});

  /// One set: its observations with residuals, and its pose; observations of quarantined markers in
  /// a call of their own. However many cameras see a marker, the set counts once for it.
  /// `trusted_cameras`: whose residuals tell of markers rather than of the camera.
  void update(Stamp stamp, std::span<const SetObservation> observations,
              const PoseSolution& solution, CameraMask trusted_cameras, std::vector<Alert>& alerts);

  /// One set: how many different markers fitted its pose, and how many did not. Where hardly any
  /// fit for long, the map is of another place: WRONG_MAP.
  void look_at_fit(Stamp stamp, int fitting, int others, std::vector<Alert>& alerts);
  [[nodiscard]] bool wrong_map() const { return wrong_map_; }

  /// Marker `map_index` is not where the map says: named, and used no more.
  void quarantine(Stamp stamp, std::size_t map_index, const Vector6d& offset,
                  std::vector<Alert>& alerts);
  /// It moves along with the vehicle: the same.
  void quarantine_riding(Stamp stamp, std::size_t map_index, std::vector<Alert>& alerts);
  /// Where a quarantined marker was found, less where the map says; zero where that is not known.
  [[nodiscard]] const Vector6d& offset_of(std::size_t map_index) const {
    return records_[map_index].offset;
  }
  /// Whether it was found to move along with the vehicle.
  [[nodiscard]] bool rides(std::size_t map_index) const {
    return records_[map_index].kind == AlertKind::marker_riding;
  }
  /// It is there again.
  void release(Stamp stamp, std::size_t map_index, std::vector<Alert>& alerts);

  /// The same of a marker of the map, or one that it lacks and that was named; false: it is neither
  /// quarantined nor named.
  bool release(Stamp stamp, const MarkerId& marker, std::vector<Alert>& alerts);

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
    Rigid3 elsewhere;  ///< where it was seen instead
    int sets_elsewhere = 0;
    int sets_in_place = 0;                     ///< lately; up to sets_back when quarantined
    double misfit = 0;                         ///< running mean of its residual there, sigmas²
    Vector6d offset = Vector6d::Zero();        ///< when it was named
    double offset_m = 0;                       ///< its length, known over restarts
    AlertKind kind = AlertKind::marker_moved;  ///< as what
    int seen = -1;                             ///< index in seen_, while a set is looked at
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
  void look_elsewhere(const SetObservation& o, const PoseSolution& solution, Record& record) const;
  void tell_unknown(Stamp stamp, const MarkerId& marker, bool raised, std::vector<Alert>& alerts);

  MapIndex& map_;
  const RigPoseSolver& solver_;
  MapWatchOptions options_;
  /// Ids that the map lacks and that are remembered; of more, the ones not seen for longest go.
  static constexpr std::size_t kMostUnknown = 64;

  std::vector<Record> records_;
  std::vector<Seen> seen_;
  std::vector<Unknown> unknown_;
  bool changed_ = false;
  double fitting_share_ = 1;  ///< of sets that show some markers: those in which most fit; running
  bool wrong_map_ = false;
};

}  // namespace waymark
