#include "mapbuilder/commands/import_command.h"

#include "core/base/output_check.h"
#include "core/map/map_file.h"
#include "core/map/map_json.h"
#include "mapbuilder/commands/print_line.h"

namespace waymark {

Status run_import(const ImportOptions& options, std::ostream& out) {
  if (auto spares = check_spares(options.output, {options.json}); !spares) return spares;
  if (auto writable = check_writable(options.output); !writable) return writable;
  const auto map = read_map_json(options.json);
  if (!map) return tl::make_unexpected(map.error());
  if (auto status = write_map_file(options.output, *map); !status) return status;
  std::size_t markers = 0;
  for (const SubMap& submap : map->submaps) markers += submap.markers.size();
  print_line(out, "{}: {} markers, content hash {}", options.output.string(), markers,
             content_hash(*map));
  return {};
}

}  // namespace waymark
