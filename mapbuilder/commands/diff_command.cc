#include "mapbuilder/commands/diff_command.h"

#include "core/map/map_file.h"
#include "mapbuilder/upkeep/difference_format.h"

namespace waymark {

Status run_diff(const DiffOptions& options, std::ostream& out) {
  const auto old_map = read_map_file(options.old_map);
  if (!old_map) return tl::make_unexpected(old_map.error());
  const auto new_map = read_map_file(options.new_map);
  if (!new_map) return tl::make_unexpected(new_map.error());
  const auto difference =
      difference_of(*old_map, options.old_map.string(), *new_map, options.new_map.string());
  if (!difference) return tl::make_unexpected(difference.error());
  out << (options.json ? format_difference_json(*difference) : format_difference_text(*difference));
  return {};
}

}  // namespace waymark
