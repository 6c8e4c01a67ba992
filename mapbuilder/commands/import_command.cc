#include "mapbuilder/commands/import_command.h"

#include "core/base/atomic_file.h"
#include "core/map/map_file.h"
#include "core/map/map_json.h"
#include "mapbuilder/commands/output_check.h"

namespace waymark {

Status run_import(const ImportOptions& options, std::ostream& out) {
  if (auto spares = check_spares(options.output, {options.json}); !spares) return spares;
  const auto text = read_file(options.json);
  if (!text) return tl::make_unexpected(text.error());
  const auto map = parse_map_json(*text, options.json.string());
  if (!map) return tl::make_unexpected(map.error());
  if (auto status = write_map_file(options.output, *map); !status) return status;
  std::size_t markers = 0;
  for (const SubMap& submap : map->submaps) markers += submap.markers.size();
  out << fmt::format("{}: {} markers, content hash {}\n", options.output.string(), markers,
                     content_hash(*map));
  return {};
}

}  // namespace waymark
