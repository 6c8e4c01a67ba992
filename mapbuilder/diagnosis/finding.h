#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/marker/marker_id.h"

namespace waymark {

/// What can be wrong with a capture, a building or a map. The names (name_of) stand in summary.json
/// and never change their meaning; new kinds are appended.
enum class FindingKind {
  wrong_id,                ///< detections that carry an id which does not belong there
  twin,                    ///< an id exists twice in the building
  moved_between_captures,  ///< a marker stands elsewhere in another capture
  moved_during_capture,    ///< a marker stands elsewhere from some moment on
  wrong_size,              ///< a marker's stated size does not fit
  rig_misfit,              ///< the rig file's extrinsics do not fit the images
  intrinsics_misfit,       ///< a camera's intrinsics do not fit its images
  survey_disagrees,        ///< an entry of the survey contradicts the others or the images
  survey_undetermined,     ///< the survey can't fix what it is meant to fix
  scale_bound,             ///< what can't be observed limits how well the scale is known
  refinement_refused,      ///< asked for, but the data can't support it
  one_view,                ///< markers that only one view places
  unmapped,                ///< markers seen that no pose explains
  unlocalized,             ///< frame sets that see markers but have no pose
  submaps,                 ///< parts that share no markers
  unsettled,               ///< adjustment and gate did not come to rest
  covariances_unknown,     ///< the observations don't fix all markers against each other
  repeated_in_image,       ///< an id was found twice in one image
  marker_moved,            ///< against an earlier map (--frame-of, --quarantine): stands elsewhere
  marker_appeared,         ///< against an earlier map or an earlier capture: new
  marker_vanished,         ///< against an earlier map or an earlier capture: no longer seen
  poor_fit,                ///< corners are far off, and nothing says why
  no_marker_seen,          ///< frame sets without a usable marker
  no_square,               ///< detections whose corners are no view of a square
  quarantine_refuted,      ///< a vehicle took it for moved, but it stands where it stood
  quarantine_open,         ///< in a vehicle's quarantine, and nothing tells whether rightly
  rigs_differ,             ///< captures of the same cameras state different calibrations
};

/// "wrong_id", "twin", …: as written above.
[[nodiscard]] std::string_view name_of(FindingKind kind);

/// How much a finding matters.
enum class Severity {
  error,    ///< the map, or a part of it, is wrong until somebody acts
  warning,  ///< kept from harming the rest, or limits what the map is good for
  note,     ///< worth knowing
};

[[nodiscard]] std::string_view name_of(Severity severity);

/// A number with its unit, as evidence: {"stated size", 0.150, "m"}.
struct Figure {
  std::string name;             ///< plain words, lower case
  double value = 0;             ///< in `unit`
  std::string unit;             ///< "m", "px", "°", "%", "σ", "s"; empty for a count
  std::optional<double> sigma;  ///< one standard deviation, in `unit`
};

/// Something that is wrong, or that limits the map, with its evidence.
struct Finding {
  FindingKind kind = FindingKind::one_view;
  Severity severity = Severity::warning;
  std::string title;                  ///< one line: "Marker 44 is 125 mm, not 150 mm"
  std::string evidence;               ///< plain words: what was seen, how sure that is
  std::string remedy;                 ///< plain words: what to do
  std::vector<MarkerId> markers;      ///< concerned, rising; sound ones are never named
  std::vector<std::string> cameras;   ///< concerned: cam0, cam1, …
  std::vector<std::string> captures;  ///< concerned, by name
  std::optional<std::size_t> submap;  ///< concerned, index in the map
  std::vector<Figure> figures;
};

/// One line for a terminal: "warning: title: evidence remedy (ids)", at most 30 ids.
[[nodiscard]] std::string one_line(const Finding& finding, bool with_family);

}  // namespace waymark
