#pragma once

#include "mapbuilder/diagnosis/finding.h"
#include "mapbuilder/diagnosis/lens_evidence.h"
#include "mapbuilder/diagnosis/rig_explanation.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// The explanation as an error; `rig` as stated.
[[nodiscard]] Finding finding_of(const RigExplanation& explanation, const Rig& rig);

/// Puts the explanation right in a capture, or leaves out what it can't be put right for (a
/// camera's images where its time is wrong). With exchanged cameras their lenses change places,
/// with images turned in the driver principal points turn; the lenses' evidence goes with the
/// images.
void put_right(const RigExplanation& explanation, DetectedCapture& capture, LensEvidence& evidence);

}  // namespace waymark
