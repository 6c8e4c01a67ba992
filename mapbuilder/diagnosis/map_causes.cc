#include "mapbuilder/diagnosis/map_causes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>

#include "core/base/median.h"
#include "core/geometry/alignment.h"
#include "core/geometry/degrees.h"
#include "mapbuilder/build/frame_comparison.h"
#include "mapbuilder/diagnosis/length_unit.h"
#include "mapbuilder/diagnosis/place_agreement.h"
#include "mapbuilder/diagnosis/turn_evidence.h"

namespace waymark {
namespace {

/// Of two maps of one place (no survey: each by its stated sizes).
const double kScaleSigma = BundleScope{}.size_sigma;
/// What somebody measured and did not say how surely (m).
constexpr double kByHand_m = 0.005;
/// Entries are named from here on (MovedLimits), and five of their sigmas.
constexpr MovedLimits kWorthNaming;
constexpr double kSigmas = 5.0;

struct Shared {
  const MapMarker* own;
  const MapMarker* mapped;
};

std::vector<Shared> shared_of(const SubMap& own, const SubMap& map) {
  std::map<MarkerId, const MapMarker*> mapped;
  for (const MapMarker& marker : map.markers) mapped.emplace(marker.id, &marker);
  std::vector<Shared> shared;
  for (const MapMarker& marker : own.markers) {
    // What was seen from one side only may itself stand anywhere.
    const auto known = mapped.find(marker.id);
    if (known != mapped.end() && marker.verified) shared.push_back({&marker, known->second});
  }
  return shared;
}

double sigma_m(const MapMarker& marker) {
  if (!marker.covariance_known()) return kByHand_m;
  return std::sqrt(marker.covariance.diagonal().head<3>().maxCoeff());
}

double sigma_rad(const MapMarker& marker) {
  if (!marker.covariance_known()) return kByHand_m;
  return std::sqrt(marker.covariance.diagonal().tail<3>().maxCoeff());
}

std::vector<MeasuredPlace> places_of(const std::vector<Shared>& shared) {
  std::vector<MeasuredPlace> places;
  for (const Shared& one : shared) {
    places.push_back({one.own->world_from_marker, one.own->size_m, Eigen::Vector3d::Zero(),
                      one.mapped->world_from_marker.translation, sigma_m(*one.mapped),
                      sigma_m(*one.own)});
  }
  return places;
}

bool on_a_line(const std::vector<Shared>& shared) {
  std::vector<Eigen::Vector3d> points;
  for (const Shared& one : shared) points.push_back(one.own->world_from_marker.translation);
  return lie_on_a_line(points);
}

/// "about its z by 90°": a turn that is simple to say.
std::string turn_text(const Eigen::Quaterniond& turn) {
  const Eigen::AngleAxisd angle_axis(turn);
  Eigen::Index axis = 0;
  angle_axis.axis().cwiseAbs().maxCoeff(&axis);
  return fmt::format("by {:.0f}° about {}", kDegreesPerRadian * angle_axis.angle(),
                     std::abs(angle_axis.axis()[axis]) > 0.99
                         ? fmt::format("{}{}", angle_axis.axis()[axis] < 0 ? "-" : "", "xyz"[axis])
                         : fmt::format("({:.2f}, {:.2f}, {:.2f})", angle_axis.axis().x(),
                                       angle_axis.axis().y(), angle_axis.axis().z()));
}

class MapJudge {
 public:
  MapJudge(const MarkerMap& map, std::vector<Shared> shared, const TurnEvidence& images)
      : images_(images),
        by_hand_(map.capture_fingerprints.empty()),
        with_family_(map.several_families()),
        shared_(std::move(shared)),
        places_(places_of(shared_)) {}

  std::vector<Finding> judge() {
    const auto agreement = agreement_of(places_, kScaleSigma);
    if (!agreement) {
      constexpr std::size_t kTellsPlaces = 4;
      if (shared_.size() >= kTellsPlaces) other_place();
      return std::move(findings_);
    }
    judge_sizes(*agreement);
    judge_common(*agreement);
    if (agreement->mirrors()) return std::move(findings_);
    judge_turns(*agreement);
    judge_entries(*agreement);
    return std::move(findings_);
  }

 private:
  void other_place() {
    add(Cause::other_place, Severity::error, {},
        fmt::format("of {} markers that capture and map share most stand otherwise to each other: "
                    "this capture does not fit this map; another building with the same ids?",
                    shared_.size()),
        "Name the map of this building; give buildings ids of their own.");
  }

  /// Sizes of the map over those of markers.toml.
  void judge_sizes(const PlaceAgreement& agreement) {
    std::vector<double> ratios;
    for (const Shared& one : shared_) ratios.push_back(one.mapped->size_m / one.own->size_m);
    std::vector<double> in_order = ratios;
    const double ratio = upper_median(in_order);
    constexpr double kSameSize = 0.005;
    size_ratio_ = ratio;
    if (std::abs(ratio - 1) > kSameSize) {
      // Where the map's lengths keep to its sizes, markers.toml is another matter.
      const bool lengths_follow =
          std::abs(agreement.scale / ratio - 1) < std::abs(agreement.scale - 1);
      Finding& finding = add(
          lengths_follow ? Cause::size_scale : Cause::map_misfit, Severity::error, {},
          fmt::format("all sizes are {:.1f} % {} in the map than in markers.toml, and its lengths "
                      "fit {}.",
                      100 * std::abs(ratio - 1), ratio > 1 ? "larger" : "smaller",
                      lengths_follow ? "its own" : "those of markers.toml"),
          lengths_follow
              ? "Measure the outer edge of a marker's black border; correct markers.toml."
              : "Correct the map's sizes: the outer edge of the black border, without "
                "the white margin.");
      finding.figures = {{"sizes", 100 * (ratio - 1), "%", {}}};
    }
    for (std::size_t i = 0; i < shared_.size(); ++i) {
      constexpr double kOtherSize = 0.01;
      if (std::abs(ratios[i] / ratio - 1) < kOtherSize) continue;
      name(i,
           fmt::format("has a size of {:.4g} m in the map and {:.4g} m in markers.toml.",
                       shared_[i].mapped->size_m, shared_[i].own->size_m),
           "Measure its black border.");
    }
  }

  void judge_common(const PlaceAgreement& agreement) {
    if (agreement.mirrors()) {
      add(Cause::map_misfit, Severity::error, {},
          "it is mirrored: its places fit only with one axis the other way (left-handed).",
          "Turn that axis round, or exchange two axes.");
    }
    if (agreement.fault == CommonFault::shifted) {
      add(Cause::map_misfit, Severity::error, {},
          fmt::format(
              "all centres are off by ({:+.2f}, {:+.2f}) of a marker's size in its plane (x "
              "right, y up): another spot of each was measured.",
              agreement.shift.x(), agreement.shift.y()),
          "position_m is the marker's centre.");
    }
    const bool scaled = agreement.fault == CommonFault::scaled ||
                        agreement.fault == CommonFault::mirrored_and_scaled;
    const bool as_sizes = std::abs(agreement.scale / size_ratio_ - 1) < kSigmas * kScaleSigma;
    if (!scaled || as_sizes) return;
    const auto unit = unit_of(agreement.scale);
    Finding& finding =
        add(Cause::map_misfit, Severity::error, {},
            unit ? fmt::format("its positions are {:.4g} times too long: in {}?", agreement.scale,
                               unit->name)
                 : fmt::format("its positions are {:.1f} % too {} for its sizes.",
                               100 * std::abs(agreement.scale - 1),
                               agreement.scale > 1 ? "long" : "short"),
            "Write positions in metres; measure the outer edge of a marker's black border.");
    finding.figures = {{"factor", agreement.scale, "", agreement.scale * agreement.scale_sigma}};
  }

  /// marker_in_map from marker: identity where both agree.
  Eigen::Quaterniond turn(const PlaceAgreement& agreement, std::size_t i) const {
    const Eigen::Quaterniond expected =
        agreement.measured_from_world.rotation * shared_[i].own->world_from_marker.rotation;
    return expected.conjugate() * shared_[i].mapped->world_from_marker.rotation;
  }

  void judge_turns(const PlaceAgreement& agreement) {
    common_turn_ = Eigen::Quaterniond::Identity();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < shared_.size(); ++i) {
      const Eigen::Quaterniond candidate = turn(agreement, i);
      std::vector<double> off;
      for (std::size_t j = 0; j < shared_.size(); ++j) {
        off.push_back(angle_between_rad(candidate, turn(agreement, j)));
      }
      if (const double middle = upper_median(off); middle < least) {
        least = middle;
        common_turn_ = candidate;
      }
    }
    turn_scatter_rad_ = least;
    const double angle = angle_between_rad(common_turn_, Eigen::Quaterniond::Identity());
    constexpr double kCommonTurn_rad = 0.09;  // 5°: more than anybody's hand leaves in all
    if (least < 0.5 * angle && angle > kCommonTurn_rad) {
      add(Cause::map_misfit, Severity::error, {},
          fmt::format("all orientations are turned {} of the marker: its axes are x right, y up, z "
                      "out of the wall; quaternions are x, y, z, w.",
                      turn_text(common_turn_)),
          "Turn the markers' axes.");
    } else {
      common_turn_ = Eigen::Quaterniond::Identity();
    }
  }

  void judge_entries(const PlaceAgreement& agreement) {
    std::vector<char> told(shared_.size(), 0);
    for (const auto& [a, b] : agreement.exchanged) {
      if (told[a] != 0 || told[b] != 0) continue;
      told[a] = told[b] = 1;
      name({a, b}, "are exchanged: each stands where the map has the other.",
           "Exchange the two ids in the map.");
    }
    for (std::size_t i = 0; i < shared_.size(); ++i) {
      if (told[i] != 0) continue;
      const double off_m = agreement.off[i] / agreement.scale;
      const double turned_rad = angle_between_rad(common_turn_, turn(agreement, i));
      const double noise_rad = std::max(
          std::hypot(sigma_rad(*shared_[i].own), sigma_rad(*shared_[i].mapped)), turn_scatter_rad_);
      const bool off = agreement.agrees[i] == 0 && off_m > kWorthNaming.distance_m;
      const bool turned =
          turned_rad > std::max(kWorthNaming.turn_rad, kSigmas * noise_rad) &&
          images_.contradicts(shared_[i].own->id, turn(agreement, i) * common_turn_.conjugate());
      if (!off && !turned) continue;
      Finding& finding =
          name(i,
               off ? fmt::format("stands {:.2g} m off where the map has it; {} others agree.",
                                 off_m, agreement.agreeing())
                   : fmt::format("is turned {} of the marker against the map.",
                                 turn_text(common_turn_.conjugate() * turn(agreement, i))),
               by_hand_ ? "Measure it again: a typing error?"
                        : "If it was moved, build a new map; if not, see what hangs there.");
      finding.figures = {{"off", off_m, "m", {}},
                         {"turned", kDegreesPerRadian * turned_rad, "°", {}}};
    }
  }

  Finding& name(std::size_t i, std::string text, std::string remedy) {
    return name(std::vector<std::size_t>{i}, std::move(text), std::move(remedy));
  }

  Finding& name(const std::vector<std::size_t>& which, std::string text, std::string remedy) {
    std::vector<MarkerId> markers;
    for (const std::size_t i : which) markers.push_back(shared_[i].own->id);
    return add(by_hand_ ? Cause::map_entry : Cause::moved, Severity::warning, std::move(markers),
               std::move(text), std::move(remedy));
  }

  Finding& add(Cause cause, Severity severity, std::vector<MarkerId> markers, std::string text,
               std::string remedy) {
    Finding finding;
    finding.cause = cause;
    finding.severity = severity;
    finding.subject = markers.empty() ? "map" : subject_of(markers, with_family_);
    finding.text = std::move(text);
    finding.remedy = std::move(remedy);
    finding.markers = std::move(markers);
    findings_.push_back(std::move(finding));
    return findings_.back();
  }

  const TurnEvidence& images_;
  bool by_hand_;
  bool with_family_;
  std::vector<Shared> shared_;
  std::vector<MeasuredPlace> places_;
  double size_ratio_ = 1;
  Eigen::Quaterniond common_turn_ = Eigen::Quaterniond::Identity();
  double turn_scatter_rad_ = 0;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> map_findings(const MarkerMap& map, const BuildResult& own,
                                  const Observations& observations) {
  const TurnEvidence images(observations, own.estimate);
  std::vector<Finding> findings;
  for (const SubMap& submap : map.submaps) {
    std::vector<Shared> shared;
    for (const BuiltSubMap& built : own.submaps) {
      auto of_this = shared_of(built.map, submap);
      if (of_this.size() > shared.size()) shared = std::move(of_this);
    }
    if (shared.size() < 3 || on_a_line(shared)) continue;
    for (Finding& finding : MapJudge(map, std::move(shared), images).judge()) {
      findings.push_back(std::move(finding));
    }
  }
  return findings;
}

bool are_of_different_places(const SubMap& a, const SubMap& b) {
  constexpr std::size_t kTellsPlaces = 4;
  const std::vector<Shared> shared = shared_of(a, b);
  return shared.size() >= kTellsPlaces && !on_a_line(shared) &&
         !agreement_of(places_of(shared), kScaleSigma);
}

}  // namespace waymark
