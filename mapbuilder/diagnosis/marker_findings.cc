#include "mapbuilder/diagnosis/marker_findings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace waymark {
namespace {

/// Puts a diagnosis into words.
class FindingWriter {
 public:
  explicit FindingWriter(const Observations& observations) : observations_(observations) {}

  [[nodiscard]] Finding wrong_size(const WrongSize& wrong) const {
    Finding finding = about(Cause::size, wrong.marker);
    finding.text = fmt::format(
        "is {:.1f} mm, not {:.1f} mm: {} views by cameras that other markers place fit a size of "
        "{:.4f} ± {:.4f} m; the sizes of {} other markers scatter by {:.2f} %. The map uses the "
        "fitted size.",
        1e3 * wrong.fitted_m, 1e3 * wrong.stated_m, wrong.views, wrong.fitted_m, wrong.sigma_m,
        wrong.markers, 1e2 * wrong.spread);
    finding.explains = fmt::format("{} views of it", wrong.views);
    finding.remedy = "Measure its black border and correct markers.toml.";
    finding.figures = {{"fitted size", wrong.fitted_m, "m", wrong.sigma_m},
                       {"stated size", wrong.stated_m, "m", {}},
                       {"scatter of other markers' sizes", 1e2 * wrong.spread, "%", {}}};
    return finding;
  }

  /// Those that are out of shape alike, to half a percent, have one reason.
  [[nodiscard]] Finding misshapen(const std::vector<const MisshapenMarker*>& alike) const {
    Finding finding;
    finding.cause = Cause::print_not_square;
    double stretch = 0;
    double sigma = 0;
    std::size_t views = 0;
    for (const MisshapenMarker* one : alike) {
      finding.markers.push_back(observations_.markers[one->marker]);
      stretch += one->stretch / static_cast<double>(alike.size());
      sigma = std::max(sigma, one->sigma);
      views += one->views;
    }
    const double narrower = -100.0 * std::expm1(-std::abs(stretch));
    finding.subject = subject_of(finding.markers, observations_.several_families());
    finding.text = fmt::format(
        "{} {:.1f} ± {:.1f} % {}, by {} views of cameras that other markers place: bent round "
        "something, or printed not square? Left out.",
        alike.size() == 1 ? "is" : "are", narrower, std::max(0.1, 100.0 * sigma),
        stretch < 0 ? "narrower than high" : "lower than wide", views);
    finding.remedy = "Measure both edges of the black border; hang it flat, or print it anew.";
    finding.explains = fmt::format("{} views of {}", views, alike.size() == 1 ? "it" : "them");
    finding.figures = {{"wider than high", 100.0 * std::expm1(stretch), "%", 100.0 * sigma}};
    return finding;
  }

  [[nodiscard]] Finding displaced(const DisplacedMarker& displaced) const {
    const PlaceCluster& a = displaced.places[0];
    const PlaceCluster& b = displaced.places[1];
    const double apart_m =
        (a.place.world_from_marker.translation - b.place.world_from_marker.translation).norm();
    const double turned_deg =
        180.0 / M_PI *
        angle_between_rad(a.place.world_from_marker.rotation, b.place.world_from_marker.rotation);
    const double sigma_m = std::hypot(a.sigma_m, b.sigma_m);
    const bool twin = displaced.history.story == PlaceStory::twin;
    const bool during = displaced.history.story == PlaceStory::moved_during_capture;
    Finding finding = about(twin ? Cause::twin : Cause::moved, displaced.marker);
    if (twin) {
      finding.text = fmt::format(
          "exists {} times: {} views place it at one spot, {} at another one {:.3f} m away, {}. "
          "Both "
          "are kept out of the map.",
          displaced.places.size() == 2 ? std::string("two")
                                       : fmt::format("{}", displaced.places.size()),
          a.views.size(), b.views.size(), apart_m,
          displaced.history.at_once       ? "at once"
          : displaced.history.interleaved ? "in turn"
                                          : "and nobody looked at one of the two while it should "
                                            "have been empty (it may also have been moved)");
      finding.remedy = "Take one of them down or give it another id, then record again.";
    } else {
      finding.text = fmt::format(
          "was moved by {:.3f} m {}: {} views place it at one spot, {} at another; in {} frame "
          "sets "
          "it would have been seen where it no longer, or not yet, was. {}",
          apart_m, during ? "during a capture" : "between captures", a.views.size(), b.views.size(),
          displaced.history.empty_looks,
          displaced.kept                ? "The map keeps the later place."
          : displaced.places.size() > 2 ? "It was seen at further places as well; it is kept out "
                                          "of the map."
                                        : "The captures' clocks don't tell which place is the "
                                          "later one; it is kept out of the map.");
      finding.remedy =
          displaced.kept
              ? "Nothing, if it stays there; waypoints that hang on its old place are stale."
              : "Build without the older captures.";
    }
    finding.figures = {{"distance between the places", apart_m, "m", sigma_m},
                       {"turned by", turned_deg, "°", {}},
                       {"views at the first place", static_cast<double>(a.views.size()), "", {}},
                       {"views at the second place", static_cast<double>(b.views.size()), "", {}}};
    finding.explains = fmt::format("{} views of it", b.views.size());
    std::set<CaptureIndex> captures;
    for (const PlaceCluster& place : displaced.places) add_captures(place.views, captures);
    finding.captures = names_of(captures);
    return finding;
  }

  /// All wrong readings of one id.
  [[nodiscard]] Finding wrong_ids(const std::vector<const WrongId*>& wrong) const {
    constexpr std::size_t kMostListed = 50;
    const MarkerIndex marker = wrong.front()->view.marker;
    Finding finding = about(Cause::wrong_id, marker);
    finding.text = fmt::format(
        "{} read as it show{} something else: ",
        wrong.size() == 1 ? std::string("a detection") : fmt::format("{} detections", wrong.size()),
        wrong.size() == 1 ? "s" : "");
    std::set<CaptureIndex> captures;
    std::set<std::string> cameras;
    for (std::size_t i = 0; i < wrong.size(); ++i) {
      const MarkerView& view = wrong[i]->view;
      const ObservedFrameSet& set = observations_.frame_sets[view.frame_set];
      captures.insert(set.capture);
      cameras.insert(view.camera->name);
      if (i >= kMostListed) continue;
      finding.text += fmt::format("{}{} in frame set {}: {}", i == 0 ? "" : "; ", view.camera->name,
                                  set.stamp.count(),
                                  wrong[i]->truly ? "it is marker " + name(*wrong[i]->truly)
                                                  : std::string("no mapped marker stands there"));
    }
    if (wrong.size() > kMostListed) {
      finding.text += fmt::format("; and {} more", wrong.size() - kMostListed);
    }
    finding.text += ". Left out.";
    finding.remedy = "Nothing, if it is rare; else clean or replace the markers that are misread.";
    finding.cameras.assign(cameras.begin(), cameras.end());
    finding.captures = names_of(captures);
    finding.explains = fmt::format("{} rejected detections", wrong.size());
    finding.figures = {{"detections with a wrong id", static_cast<double>(wrong.size()), "", {}}};
    return finding;
  }

  [[nodiscard]] Finding riding(const RidingMarker& riding) const {
    Finding finding = about(Cause::riding, riding.marker);
    std::set<std::string> cameras;
    for (const MarkerView& view : riding.views) cameras.insert(view.camera->name);
    finding.cameras.assign(cameras.begin(), cameras.end());
    finding.text = fmt::format(
        "moves with the rig: {} views of {} have it always at one place, while the rig went {:.1f} "
        "m. Left out.",
        riding.views.size(), fmt::join(finding.cameras, ", "), riding.way_m);
    finding.remedy = "Put it into `ignore` in markers.toml.";
    finding.explains = fmt::format("{} views of it", riding.views.size());
    finding.figures = {{"views", static_cast<double>(riding.views.size()), "", {}},
                       {"way of the rig", riding.way_m, "m", {}}};
    return finding;
  }

  [[nodiscard]] Finding restless(const RestlessMarker& restless) const {
    Finding finding = about(Cause::moved, restless.marker);
    finding.text =
        fmt::format("moves all the time: hardly two of {} views agree on where it is. Left out.",
                    restless.views.size());
    finding.remedy = "Does it ride on something? Put it into `ignore` in markers.toml.";
    finding.figures = {{"views", static_cast<double>(restless.views.size()), "", {}}};
    return finding;
  }

  [[nodiscard]] Finding group(const MovingGroup& group) const {
    Finding finding;
    finding.cause = Cause::moving_group;
    for (const MarkerIndex marker : group.markers) {
      finding.markers.push_back(observations_.markers[marker]);
    }
    finding.subject = subject_of(finding.markers, observations_.several_families());
    finding.text = fmt::format(
        "also seen together in {} images, alike to each other and not where they hang: a board "
        "with their ids? These {} detections are left out.",
        group.images, group.views.size());
    finding.remedy = "Keep boards out of captures, or give them ids of their own.";
    finding.figures = {{"detections left out", static_cast<double>(group.views.size()), "", {}}};
    return finding;
  }

  [[nodiscard]] Finding part_time(const PartTimeMarker& marker) const {
    const bool came = marker.appeared.value_or(false);
    Finding finding = about(Cause::moved, marker.marker);
    finding.severity = Severity::note;
    const std::set<CaptureIndex> seen(marker.seen_in.begin(), marker.seen_in.end());
    const std::set<CaptureIndex> empty(marker.empty_in.begin(), marker.empty_in.end());
    finding.text = fmt::format(
        "{}: it is seen in {}; in {} {} frame sets look at its place with clear sight and do not "
        "find it.",
        !marker.appeared ? "hangs in some captures and not in others"
        : came           ? "is new"
                         : "is gone",
        fmt::join(names_of(seen), ", "), fmt::join(names_of(empty), ", "), marker.empty_looks);
    if (!came) finding.remedy = "If it hangs there still, see what covers it; the map keeps it.";
    finding.captures = names_of(empty);
    finding.figures = {
        {"looks that did not find it", static_cast<double>(marker.empty_looks), "", {}}};
    return finding;
  }

 private:
  [[nodiscard]] Finding about(Cause cause, MarkerIndex marker) const {
    Finding finding;
    finding.cause = cause;
    finding.markers = {observations_.markers[marker]};
    finding.subject = subject_of(finding.markers, observations_.several_families());
    return finding;
  }

  [[nodiscard]] std::string name(MarkerIndex marker) const {
    return format_marker_id(observations_.markers[marker], observations_.several_families());
  }

  void add_captures(const std::vector<MarkerView>& views, std::set<CaptureIndex>& captures) const {
    for (const MarkerView& view : views) {
      captures.insert(observations_.frame_sets[view.frame_set].capture);
    }
  }

  [[nodiscard]] std::vector<std::string> names_of(const std::set<CaptureIndex>& captures) const {
    std::vector<std::string> names;
    for (const CaptureIndex c : captures) names.push_back(observations_.captures[c].name);
    return names;
  }

  const Observations& observations_;
};

/// Those of one finding, each group by rising index.
std::vector<std::vector<const MisshapenMarker*>> alike_in_shape(
    const std::vector<MisshapenMarker>& misshapen) {
  constexpr double kAlike = 0.005;
  std::vector<std::vector<const MisshapenMarker*>> groups;
  for (const MisshapenMarker& one : misshapen) {
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& known) {
      return std::abs(known.front()->stretch - one.stretch) <= kAlike;
    });
    if (group == groups.end()) {
      groups.push_back({&one});
    } else {
      group->push_back(&one);
    }
  }
  return groups;
}

}  // namespace

std::vector<Finding> marker_findings(const Observations& observations,
                                     const MarkerDiagnosis& diagnosis) {
  const FindingWriter writer(observations);
  std::vector<Finding> findings;
  for (const auto& alike : alike_in_shape(diagnosis.misshapen)) {
    findings.push_back(writer.misshapen(alike));
  }
  for (const WrongSize& wrong : diagnosis.sizes) findings.push_back(writer.wrong_size(wrong));
  for (const DisplacedMarker& marker : diagnosis.displaced) {
    findings.push_back(writer.displaced(marker));
  }
  for (const RidingMarker& marker : diagnosis.riding) findings.push_back(writer.riding(marker));
  for (const MovingGroup& group : diagnosis.groups) findings.push_back(writer.group(group));
  for (const RestlessMarker& marker : diagnosis.restless) {
    findings.push_back(writer.restless(marker));
  }
  std::map<MarkerIndex, std::vector<const WrongId*>> by_marker;
  for (const auto* wrong_ids : {&diagnosis.wrong_ids, &diagnosis.strays}) {
    for (const WrongId& wrong : *wrong_ids) {
      by_marker[wrong.view.marker].push_back(&wrong);
    }
  }
  for (const auto& [marker, wrong] : by_marker) findings.push_back(writer.wrong_ids(wrong));
  for (const PartTimeMarker& marker : diagnosis.part_time) {
    findings.push_back(writer.part_time(marker));
  }
  return findings;
}

}  // namespace waymark
