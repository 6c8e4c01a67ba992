#pragma once

#include <string>
#include <vector>

#include "core/base/error.h"
#include "mapbuilder/print/sheet.h"

namespace waymark {

/// The sheets as a PDF of exact black squares, one page each. The ids lie within their families,
/// whose bits are known (both checked). internal: what the library says.
[[nodiscard]] Expected<std::string> pdf_of(const std::vector<Sheet>& sheets);

}  // namespace waymark
