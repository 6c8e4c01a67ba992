// Prints the page of all causes: docs/findings.md is this program's output.
#include <fmt/format.h>

#include "core/base/cause.h"

namespace {

constexpr std::string_view kHead = R"(# What findings mean

Made by `scripts/findings-page` of core/base/cause.cc: change that.

`mapbuilder` and `locd --check` say what is wrong, or limits a result, in lines of one form on stderr:

    SEVERITY [cause] subject: text

*error*: the result must not be used. `build` then ends with 65, writes the report, and puts the map into `MAP.rejected`; an existing MAP stays as it
is. `--accept-errors` writes MAP all the same. *warning*: what was found is kept from harming the rest, or limits what the result is good for;
`--strict` makes warnings errors. *note*: worth knowing. A terminal shows one line per cause, the worst first; `--report` has all of them, in
summary.json with value, sigma and unit, what is explained by it, and what to do.
)";

}  // namespace

int main() {
  fmt::print("{}", kHead);
  std::string_view about;
  for (const waymark::CauseText& text : waymark::all_causes()) {
    if (text.about != about) {
      about = text.about;
      fmt::print(
          "\n## {}\n\n| cause | what it means | how it is told | what to do |\n|---|---|---|---|\n",
          about);
    }
    fmt::print("| {} | {} | {} | {} |\n", text.name, text.means, text.told, text.remedy);
  }
  return 0;
}
