#include <fmt/format.h>

#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "core/marker/id_range.h"
#include "core/marker/marker_catalog.h"

namespace waymark {
namespace {

/// A TOML string of a printable text.
std::string quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

std::string format_marker_catalog(const MarkerCatalog& catalog) {
  std::string text;
  for (const auto& entry : catalog.entries()) {
    text += fmt::format("[[markers]]\nfamily = \"{}\"\n", name_of(entry.family));
    if (entry.default_size_m) text += fmt::format("size_m = {}\n", *entry.default_size_m);
    if (entry.default_size_sigma_m) {
      text += fmt::format("size_sigma_m = {}\n", *entry.default_size_sigma_m);
    }
    if (entry.inverted) text += "inverted = true\n";
    if (!entry.ignored.empty()) {
      text += fmt::format("ignore = \"{}\"\n", format_id_ranges(std::vector<int>(
                                                   entry.ignored.begin(), entry.ignored.end())));
    }
    // Size, its sigma (0: not stated) and group.
    std::map<std::tuple<double, double, std::string>, std::vector<int>> ids_by_block;
    for (const auto& [id, size_m] : entry.size_m_by_id) {
      const auto sigma = entry.size_sigma_m_by_id.find(id);
      const double sigma_m = sigma == entry.size_sigma_m_by_id.end() ? 0 : sigma->second;
      const auto group = entry.group_by_id.find(id);
      ids_by_block[{size_m, sigma_m, group == entry.group_by_id.end() ? "" : group->second}]
          .push_back(id);
    }
    for (const auto& [block, ids] : ids_by_block) {
      const auto& [size_m, sigma_m, group] = block;
      text += fmt::format("[[markers.sizes]]\nids = \"{}\"\nsize_m = {}\n", format_id_ranges(ids),
                          size_m);
      if (sigma_m > 0) text += fmt::format("size_sigma_m = {}\n", sigma_m);
      if (!group.empty()) text += fmt::format("group = {}\n", quoted(group));
    }
    text += '\n';
  }
  return text;
}

}  // namespace waymark
