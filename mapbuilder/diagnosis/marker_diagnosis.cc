#include "mapbuilder/diagnosis/marker_diagnosis.h"

#include <algorithm>
#include <set>

#include "core/base/parallel.h"

namespace waymark {
namespace {

/// What is found out about one marker.
struct MarkerVerdict {
  std::vector<WrongId> wrong_ids;
  std::vector<PlaceCluster> places;  ///< only where something contradicts the mapped one
  std::vector<MarkerView> strays;    ///< at none of its places
};

class MarkerJudge {
 public:
  MarkerJudge(const MapEvidence& evidence, const DiagnosisOptions& options)
      : evidence_(evidence),
        options_(options),
        places_(evidence.table().markers.size()),
        verdicts_(places_.size()) {
    for (std::size_t m = 0; m < places_.size(); ++m) {
      const int marker = static_cast<int>(m);
      if (!evidence.place(marker)) continue;
      if (stands_on_another(evidence, marker) || too_rare(marker)) {
        doubtful_.insert(marker);
      } else {
        places_[m].push_back(*evidence.place(marker));
      }
    }
  }

  MarkerDiagnosis judge() {
    MarkerDiagnosis diagnosis;
    diagnosis.sizes = find_wrong_sizes(evidence_, options_.size);
    // A marker of wrong size seems to be where it is not; it is judged again when its size is
    // right.
    std::vector<char> judged(places_.size(), 1);
    for (const WrongSize& wrong : diagnosis.sizes)
      judged[static_cast<std::size_t>(wrong.marker)] = 0;

    parallel_for(places_.size(), evidence_.options().threads, [&](std::size_t m) {
      if (judged[m] != 0) verdicts_[m] = first_verdict(static_cast<int>(m));
    });
    for (std::size_t m = 0; m < places_.size(); ++m) {
      if (verdicts_[m].places.empty()) continue;
      places_[m].clear();
      for (const PlaceCluster& cluster : verdicts_[m].places) places_[m].push_back(cluster.place);
    }
    for (std::size_t m = 0; m < places_.size(); ++m) {
      if (judged[m] != 0) conclude(static_cast<int>(m), diagnosis);
    }
    return diagnosis;
  }

 private:
  /// What the marker's own views and the mapped places of the others tell.
  [[nodiscard]] MarkerVerdict first_verdict(int marker) const {
    MarkerVerdict verdict;
    std::vector<MarkerView> firm;
    bool contradicted = false;
    for (const MarkerView& view : evidence_.views_of(marker, 1)) {
      if (!view.accepted || doubtful_.contains(marker)) {
        if (const auto wrong = wrong_id(view)) {
          verdict.wrong_ids.push_back(*wrong);
          continue;
        }
      }
      if (view.others < 2) continue;
      contradicted = contradicted || !view.accepted;
      firm.push_back(view);
    }
    if (!contradicted) return verdict;
    verdict.places = find_places(evidence_, firm, options_.places);
    const double gate = evidence_.options().gate.reject_sigmas;
    for (const MarkerView& view : firm) {
      const bool fits = std::any_of(verdict.places.begin(), verdict.places.end(),
                                    [&](const PlaceCluster& cluster) {
                                      return misfit_sigmas2(view, cluster.place) <= gate * gate;
                                    });
      if (!fits && !view.accepted) verdict.strays.push_back(view);
    }
    if (verdict.places.size() < 2) verdict.places.clear();
    return verdict;
  }

  /// The view as a wrong id, when another mapped marker stands where it was seen.
  [[nodiscard]] std::optional<WrongId> wrong_id(const MarkerView& view) const {
    const auto& own = places_[static_cast<std::size_t>(view.observation->marker)];
    if (nearest_px(view, own) < options_.wrong_ids.least_to_own * side_px(view)) return {};
    const int shown = marker_shown(view, places_, options_.wrong_ids);
    if (shown < 0) return {};
    return WrongId{view, shown};
  }

  /// Too few views to say that a marker is there: a wrong id looks the same.
  [[nodiscard]] bool too_rare(int marker) const {
    constexpr std::ptrdiff_t kLeastViews = 3;
    const auto views = evidence_.views_of(marker, 0);
    return std::count_if(views.begin(), views.end(),
                         [](const MarkerView& v) { return v.accepted; }) < kLeastViews;
  }

  /// What is left when all places of all markers are known.
  void conclude(int marker, MarkerDiagnosis& diagnosis) const {
    const MarkerVerdict& verdict = verdicts_[static_cast<std::size_t>(marker)];
    diagnosis.wrong_ids.insert(diagnosis.wrong_ids.end(), verdict.wrong_ids.begin(),
                               verdict.wrong_ids.end());
    const auto& own = places_[static_cast<std::size_t>(marker)];
    for (const MarkerView& view : verdict.strays) {
      if (const auto wrong = wrong_id(view)) {
        diagnosis.wrong_ids.push_back(*wrong);
      } else if (!own.empty() && view.others >= options_.wrong_ids.least_others_alone &&
                 nearest_px(view, own) > options_.wrong_ids.least_to_own_alone * side_px(view)) {
        diagnosis.wrong_ids.push_back({view, -1});
      }
    }
    if (verdict.places.empty()) {
      if (doubtful_.contains(marker) && verdict.wrong_ids.empty() && verdict.strays.empty()) {
        for (const MarkerView& view : evidence_.views_of(marker, 1)) {
          if (const auto wrong = wrong_id(view)) diagnosis.wrong_ids.push_back(*wrong);
        }
      }
      return;
    }
    DisplacedMarker displaced;
    displaced.marker = marker;
    displaced.places = verdict.places;
    displaced.history = history_of(evidence_, verdict.places[0], verdict.places[1]);
    if (verdict.places.size() == 2 && displaced.history.story != PlaceStory::twin &&
        displaced.history.second_is_later) {
      displaced.kept = *displaced.history.second_is_later ? 1 : 0;
    }
    diagnosis.displaced.push_back(std::move(displaced));
  }

  const MapEvidence& evidence_;
  DiagnosisOptions options_;
  std::vector<std::vector<SizedPlace>> places_;  ///< per marker
  std::vector<MarkerVerdict> verdicts_;
  std::set<int> doubtful_;  ///< mapped, but perhaps only read off other markers
};

}  // namespace

MarkerDiagnosis diagnose_markers(const MapEvidence& evidence, const DiagnosisOptions& options) {
  return MarkerJudge(evidence, options).judge();
}

}  // namespace waymark
