#include "mapbuilder/upkeep/flipped_markers.h"

#include "mapbuilder/growth/placement_views.h"

namespace waymark {
namespace {

/// A marker of a part, its earlier place, and how the part's views judge places of it.
class Judge {
 public:
  Judge(const RoundParts& round, const RoundPart& part, MarkerIndex marker, const Rigid3& earlier)
      : round_(round), part_(part), marker_(marker), earlier_(earlier) {}

  [[nodiscard]] std::vector<PlacementView> views(const Estimate& estimate) const {
    const auto most = static_cast<std::size_t>(growth().max_placement_views);
    return placement_views(round_.prepared(), estimate, marker_, most,
                           [](FrameSetIndex) { return true; });
  }

  /// Whether a place is turned less against the earlier one than the estimate's is.
  [[nodiscard]] bool is_nearer(const Rigid3& place) const {
    return turn_of(place) <
           turn_of(*round_.estimate().world_from_marker[marker_]) - growth().placement.distinct_rad;
  }

  /// The other placement that the views allow, if it is nearer.
  [[nodiscard]] std::optional<Rigid3> by_runner_up() const {
    const auto seen = views(round_.estimate());
    const auto found = place_marker(seen, growth().placement);
    if (!found) return std::nullopt;
    if (is_nearer(found->best.pose)) return found->best.pose;
    const bool open = found->runner_up && found->gap < growth().placement_gap;
    if (open && is_nearer(found->runner_up->pose)) return found->runner_up->pose;
    return std::nullopt;
  }

  /// Where the whole part settles with the marker at its earlier place, if its views like that as
  /// well.
  [[nodiscard]] std::optional<Rigid3> by_earlier_place(const MarkerId& id) const {
    const Estimate trial = round_.adjusted_from(part_, {{id, earlier_}});
    const Rigid3& settled = *trial.world_from_marker[marker_];
    if (!is_nearer(settled)) return std::nullopt;
    const Estimate& now = round_.estimate();
    const double worse =
        placement_score(views(trial), settled, growth().placement) -
        placement_score(views(now), *now.world_from_marker[marker_], growth().placement);
    if (worse >= growth().placement_gap) return std::nullopt;
    return settled;
  }

 private:
  [[nodiscard]] const GrowthOptions& growth() const { return round_.options().growth; }
  [[nodiscard]] double turn_of(const Rigid3& in_estimate) const {
    return angle_between_rad((part_.world_from_estimate * in_estimate).rotation, earlier_.rotation);
  }

  const RoundParts& round_;
  const RoundPart& part_;
  MarkerIndex marker_;
  Rigid3 earlier_;
};

}  // namespace

std::map<MarkerId, Rigid3> unflipped(const RoundParts& round, const RoundPart& part,
                                     const std::map<MarkerId, Rigid3>& earlier) {
  std::map<MarkerId, Rigid3> places;
  for (const auto& [id, place] : earlier) {
    const auto m = round.index_of(id);
    if (!m || !round.estimate().world_from_marker[*m]) continue;
    const Judge judge(round, part, *m, place);
    auto nearer = judge.by_runner_up();
    if (!nearer) nearer = judge.by_earlier_place(id);
    if (nearer) places[id] = part.world_from_estimate * *nearer;
  }
  return places;
}

}  // namespace waymark
