#pragma once

#include <string>

#include "core/base/error.h"

namespace waymark {

/// A sheet's size, as it lies in front of one.
struct Paper {
  double width_mm = 210;
  double height_mm = 297;

  [[nodiscard]] Paper turned() const { return {height_mm, width_mm}; }
};

/// "a4", "a3", "letter", or "WIDTHxHEIGHT" in mm, each within 50 and 2000. usage for anything else.
[[nodiscard]] Expected<Paper> paper_from_name(const std::string& name);

}  // namespace waymark
