#include "mapbuilder/diagnosis/marker_diagnosis.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/base/range.h"

namespace waymark {
namespace {

/// What is found out about one marker.
struct MarkerVerdict {
  std::vector<WrongId> wrong_ids;
  std::optional<DisplacedMarker> displaced;
  std::optional<RidingMarker> riding;
  std::optional<RestlessMarker> restless;
  std::vector<MarkerView> strays;  ///< at none of its places
  /// Where most views have it, though the map, by those below, has it elsewhere.
  std::optional<SizedPlace> better_home;
  std::vector<MarkerView> usurpers;
};

/// Too few views to say what stands there: a wrong id looks the same, and proves nothing about
/// others.
constexpr std::ptrdiff_t kFewViews = 3;

class MarkerJudge {
 public:
  MarkerJudge(const MapEvidence& evidence, const DiagnosisOptions& options)
      : evidence_(evidence),
        options_(options),
        places_(evidence.observations().markers.size()),
        judge_(evidence, places_, options.wrong_ids) {
    for (const MarkerIndex marker : evidence.markers()) {
      if (!evidence.place(marker)) continue;
      if (views_of(marker, true) < kFewViews || stands_on_another(evidence, marker)) {
        doubtful_.insert(marker);
      } else {
        places_[marker].push_back(*evidence.place(marker));
      }
    }
  }

  MarkerDiagnosis diagnose() {
    MarkerDiagnosis diagnosis;
    diagnosis.misshapen = find_misshapen_markers(evidence_, options_.prints);
    diagnosis.sizes = find_wrong_sizes(evidence_, options_.prints);
    std::vector<MarkerIndex> judged = evidence_.markers();
    // One that is narrower than high seems to be smaller, and where it is not.
    for (const MisshapenMarker& one : diagnosis.misshapen) {
      std::erase(judged, one.marker);
      std::erase_if(diagnosis.sizes,
                    [&](const WrongSize& wrong) { return wrong.marker == one.marker; });
    }
    // A marker of wrong size seems to be where it is not; it is judged when its size is right.
    constexpr double kRight = 0.01;
    for (const WrongSize& wrong : diagnosis.sizes) {
      const double used_m = evidence_.size_m(wrong.marker);
      if (std::abs(wrong.fitted_m / used_m - 1.0) > kRight) std::erase(judged, wrong.marker);
    }

    std::vector<MarkerVerdict> verdicts(judged.size());
    parallel_for(judged.size(), evidence_.options().threads,
                 [&](std::size_t i) { verdicts[i] = verdict_of(judged[i]); });
    for (std::size_t i = 0; i < judged.size(); ++i) {
      auto& places = places_[judged[i]];
      if (verdicts[i].better_home) places = {*verdicts[i].better_home};
      if (!verdicts[i].displaced) continue;
      places.clear();
      for (const PlaceCluster& cluster : verdicts[i].displaced->places) {
        places.push_back(cluster.place);
      }
    }
    // Now that all places of all markers are known:
    std::vector<WrongId>& wrong_ids = diagnosis.wrong_ids;
    for (MarkerVerdict& verdict : verdicts) {
      wrong_ids.insert(wrong_ids.end(), verdict.wrong_ids.begin(), verdict.wrong_ids.end());
      for (const MarkerView& view : verdict.strays) {
        if (const auto wrong = judge_.wrong_id(view)) {
          wrong_ids.push_back(*wrong);
        } else if (const auto stray = judge_.stray(view)) {
          diagnosis.strays.push_back(*stray);
        }
      }
      for (const MarkerView& view : verdict.usurpers) {
        wrong_ids.push_back(judge_.wrong_id(view).value_or(WrongId{view, std::nullopt}));
      }
      if (verdict.displaced) diagnosis.displaced.push_back(*std::move(verdict.displaced));
      if (verdict.riding) diagnosis.riding.push_back(*std::move(verdict.riding));
      if (verdict.restless) diagnosis.restless.push_back(*std::move(verdict.restless));
    }
    name_groups(judged, diagnosis);
    for (const FrameSetIndex frame_set : contradictory_pairs(wrong_ids)) {
      if (const auto wrong = judge_.wrong_of_two(frame_set)) wrong_ids.push_back(*wrong);
    }
    diagnosis.part_time = find_part_time_markers(evidence_, options_.presence);
    std::erase_if(diagnosis.part_time, [&](const PartTimeMarker& marker) {
      return doubtful_.contains(marker.marker) ||
             std::any_of(diagnosis.displaced.begin(), diagnosis.displaced.end(),
                         [&](const auto& d) { return d.marker == marker.marker; });
    });
    return diagnosis;
  }

 private:
  /// Groups take their views out of the wrong ids, and their markers out of those that move all the
  /// time: one cause, one finding.
  void name_groups(const std::vector<MarkerIndex>& judged, MarkerDiagnosis& diagnosis) const {
    std::vector<MarkerView> elsewhere;
    std::size_t all = 0;
    for (const MarkerIndex marker : judged) {
      for (const MarkerView& view : evidence_.views_of(marker, 2)) {
        ++all;
        const bool home = std::any_of(
            places_[marker].begin(), places_[marker].end(), [&](const SizedPlace& place) {
              return distance_px(view, place) < options_.wrong_ids.least_to_own * side_px(view);
            });
        if (!home) elsewhere.push_back(view);
      }
    }
    // Where much lies elsewhere something else is wrong than a board.
    constexpr std::size_t kOneIn = 4;
    if (kOneIn * elsewhere.size() > all) return;
    diagnosis.groups = find_moving_groups(evidence_, elsewhere, options_.movement);
    std::erase_if(diagnosis.restless, [&](const RestlessMarker& restless) {
      return std::any_of(
          diagnosis.groups.begin(), diagnosis.groups.end(), [&](const MovingGroup& group) {
            return std::binary_search(group.markers.begin(), group.markers.end(), restless.marker);
          });
    });
    std::set<ObservationIndex> taken;
    for (const MovingGroup& group : diagnosis.groups) {
      for (const MarkerView& view : group.views) taken.insert(view.index);
    }
    for (auto* wrong_ids : {&diagnosis.wrong_ids, &diagnosis.strays}) {
      std::erase_if(*wrong_ids,
                    [&](const WrongId& wrong) { return taken.contains(wrong.view.index); });
    }
  }

  /// What the marker's own views and the mapped places of the others tell.
  [[nodiscard]] MarkerVerdict verdict_of(MarkerIndex marker) const {
    MarkerVerdict verdict;
    std::vector<MarkerView> firm;
    bool contradicted = false;
    for (const MarkerView& view : evidence_.views_of(marker, 1)) {
      const bool contradicts = !view.accepted && !at_home(view);
      if (contradicts || doubtful_.contains(marker)) {
        if (const auto wrong = judge_.wrong_id(view)) {
          verdict.wrong_ids.push_back(*wrong);
          continue;
        }
      }
      if (view.others < 2) continue;
      contradicted = contradicted || contradicts;
      firm.push_back(view);
    }
    if (views_of(marker, false) < kFewViews) {
      verdict.strays = firm;
      return verdict;
    }
    if (!contradicted) return verdict;
    verdict.riding = find_riding(firm, options_.movement);
    if (verdict.riding) return verdict;
    const auto places = find_places(evidence_, firm, options_.places);
    verdict.displaced = displaced(marker, places);
    if (places.empty()) {
      verdict.restless = find_restless(firm, options_.movement);
      if (verdict.restless) return verdict;
    }
    if (!verdict.displaced && !places.empty()) find_better_home(places.front(), firm, verdict);
    if (verdict.better_home) return verdict;
    for (const MarkerView& view : firm) {
      if (view.accepted || at_home(view)) continue;
      const bool fits = verdict.displaced &&
                        std::any_of(places.begin(), places.end(), [&](const PlaceCluster& cluster) {
                          return fits_at(view, cluster.place);
                        });
      if (!fits) verdict.strays.push_back(view);
    }
    return verdict;
  }

  /// A place that three views and more speak for, and twice as many as those that the map goes by,
  /// of which it holds none.
  void find_better_home(const PlaceCluster& place, const std::vector<MarkerView>& firm,
                        MarkerVerdict& verdict) const {
    std::vector<MarkerView> usurpers;
    for (const MarkerView& view : firm) {
      if (!view.accepted) continue;
      if (fits_at(view, place.place)) return;
      usurpers.push_back(view);
    }
    if (usurpers.empty() || place.views.size() <= 2 * usurpers.size()) return;
    verdict.better_home = place.place;
    verdict.usurpers = std::move(usurpers);
    for (const MarkerView& view : firm) {
      if (!view.accepted && !fits_at(view, place.place)) verdict.strays.push_back(view);
    }
  }

  [[nodiscard]] std::ptrdiff_t views_of(MarkerIndex marker, bool accepted_only) const {
    const auto views = evidence_.views_of(marker, 0);
    return std::count_if(views.begin(), views.end(),
                         [&](const MarkerView& view) { return view.accepted || !accepted_only; });
  }

  [[nodiscard]] bool fits_at(const MarkerView& view, const SizedPlace& place) const {
    return misfit_sigmas2(view, place) <= evidence_.gate_sigmas2();
  }

  /// Whether the view shows the marker where the map has it.
  [[nodiscard]] bool at_home(const MarkerView& view) const {
    const auto& home = evidence_.place(view.marker);
    return home && fits_at(view, *home);
  }

  [[nodiscard]] std::optional<DisplacedMarker> displaced(
      MarkerIndex marker, const std::vector<PlaceCluster>& places) const {
    DisplacedMarker displaced;
    displaced.marker = marker;
    for (const PlaceCluster& place : places) {
      if (!displaced.places.empty()) {
        const PlaceHistory history =
            history_of(evidence_, displaced.places.front(), place, options_.history);
        if (history.story == PlaceStory::none) continue;
        if (displaced.places.size() == 1) displaced.history = history;
      }
      displaced.places.push_back(place);
    }
    if (displaced.places.size() < 2) return std::nullopt;
    if (displaced.places.size() == 2 && displaced.history.story != PlaceStory::twin &&
        displaced.history.second_is_later) {
      displaced.kept = *displaced.history.second_is_later ? 1 : 0;
    }
    return displaced;
  }

  /// Frame sets that see two markers of which the gate rejects one or both, and of which nothing is
  /// known to be wrong yet.
  [[nodiscard]] std::vector<FrameSetIndex> contradictory_pairs(
      const std::vector<WrongId>& known) const {
    std::set<FrameSetIndex> done;
    for (const WrongId& wrong : known) done.insert(wrong.view.frame_set);
    std::vector<FrameSetIndex> pairs;
    for (const FrameSetIndex frame_set : evidence_.frame_sets()) {
      if (done.contains(frame_set)) continue;
      const auto views = evidence_.views_in(frame_set);
      if (views.size() == 2 && !(views[0].accepted && views[1].accepted)) {
        pairs.push_back(frame_set);
      }
    }
    return pairs;
  }

  const MapEvidence& evidence_;
  DiagnosisOptions options_;
  PlacesOfMarkers places_;
  WrongIdJudge judge_;
  std::set<MarkerIndex> doubtful_;  ///< mapped, but perhaps only read off other markers
};

}  // namespace

Status DiagnosisOptions::check() const {
  return RangeCheck()
      .part("prints", prints.check())
      .part("places", places.check())
      .part("history", history.check())
      .part("wrong_ids", wrong_ids.check())
      .part("presence", presence.check())
      .status();
}

MarkerDiagnosis diagnose_markers(const MapEvidence& evidence, const DiagnosisOptions& options) {
  WAYMARK_CHECK(options.check().has_value());
  return MarkerJudge(evidence, options).diagnose();
}

}  // namespace waymark
