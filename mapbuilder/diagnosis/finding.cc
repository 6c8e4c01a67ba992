#include "mapbuilder/diagnosis/finding.h"

#include <array>

namespace waymark {
namespace {

constexpr std::array<std::string_view, 21> kKinds{"wrong_id",
                                                  "twin",
                                                  "moved_between_captures",
                                                  "moved_during_capture",
                                                  "wrong_size",
                                                  "rig_misfit",
                                                  "intrinsics_misfit",
                                                  "survey_disagrees",
                                                  "survey_undetermined",
                                                  "scale_bound",
                                                  "refinement_refused",
                                                  "one_view",
                                                  "unmapped",
                                                  "unlocalized",
                                                  "submaps",
                                                  "unsettled",
                                                  "covariances_unknown",
                                                  "repeated_in_image",
                                                  "marker_moved",
                                                  "marker_appeared",
                                                  "marker_vanished"};
static_assert(kKinds[static_cast<std::size_t>(FindingKind::marker_vanished)] == "marker_vanished");

constexpr std::array<std::string_view, 3> kSeverities{"error", "warning", "note"};

}  // namespace

std::string_view name_of(FindingKind kind) { return kKinds.at(static_cast<std::size_t>(kind)); }

std::string_view name_of(Severity severity) {
  return kSeverities.at(static_cast<std::size_t>(severity));
}

}  // namespace waymark
