#include "mapbuilder/print/paper.h"

#include "core/base/range.h"
#include "core/base/text_field.h"

namespace waymark {

Expected<Paper> paper_from_name(const std::string& name) {
  if (name == "a4") return Paper{210, 297};
  if (name == "a3") return Paper{297, 420};
  if (name == "letter") return Paper{215.9, 279.4};
  constexpr Range kSide_mm{50, 2000};
  const auto by = name.find('x');
  const std::string_view text = name;
  const auto width = parse_whole<double>(text.substr(0, by));
  std::optional<double> height;
  if (by != std::string::npos) height = parse_whole<double>(text.substr(by + 1));
  if (!width || !height || !kSide_mm.contains(*width) || !kSide_mm.contains(*height)) {
    return fail(ErrorKind::usage,
                "--paper {}: it is a4, a3, letter, or width x height in mm such as 300x400, each "
                "within {} and {}",
                name, kSide_mm.low, kSide_mm.high);
  }
  return Paper{*width, *height};
}

}  // namespace waymark
