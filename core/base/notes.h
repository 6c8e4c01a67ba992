#pragma once

#include <string>
#include <vector>

#include "core/base/cause.h"

namespace waymark {

/// The lines in which notes about one input are shown: each printable, the first 20 of them, and
/// then how many more there are.
[[nodiscard]] std::vector<std::string> shown_notes(const std::vector<std::string>& notes);

/// A note that has a cause of docs/findings.md: "[format] rig.yaml: …".
[[nodiscard]] std::string caused_note(Cause cause, const std::string& text);

/// What a command prints of a shown note: "note: …", or "note [cause] …" of one that has a cause.
[[nodiscard]] std::string note_line(const std::string& shown);

}  // namespace waymark
