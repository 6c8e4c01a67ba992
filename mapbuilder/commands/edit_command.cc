#include "mapbuilder/commands/edit_command.h"

#include <fmt/ostream.h>

#include <algorithm>

#include "core/base/output_check.h"
#include "core/map/map_edit.h"
#include "core/map/map_file.h"
#include "core/map/marker_search.h"
#include "core/marker/marker_id_list.h"
#include "mapbuilder/commands/print_line.h"

namespace waymark {
namespace {

Expected<std::vector<MarkerId>> read_ids(const char* option, const std::vector<std::string>& texts,
                                         std::optional<Family> family) {
  std::vector<MarkerId> all;
  for (const std::string& text : texts) {
    const auto ids = parse_marker_ids(text, family);
    if (!ids) return fail(ids.error().kind, "{} {}: {}", option, text, ids.error().message);
    all.insert(all.end(), ids->begin(), ids->end());
  }
  return all;
}

Expected<std::pair<MarkerId, MarkerId>> read_rename(const std::string& text,
                                                    std::optional<Family> family) {
  const auto equals = text.find('=');
  if (equals == std::string::npos) {
    return fail(ErrorKind::usage, "--rename {}: write ID=ID, such as 12=40", text);
  }
  const auto from = parse_marker_id(std::string_view(text).substr(0, equals), family);
  if (!from) return fail(from.error().kind, "--rename {}: {}", text, from.error().message);
  // The new name is of the same family unless it says otherwise.
  const auto to = parse_marker_id(std::string_view(text).substr(equals + 1), from->family);
  if (!to) return fail(to.error().kind, "--rename {}: {}", text, to.error().message);
  return std::pair{*from, *to};
}

Expected<MapEdit> read_edit(const EditOptions& options, std::optional<Family> family) {
  MapEdit edit;
  auto remove = read_ids("--remove", options.remove, family);
  if (!remove) return tl::make_unexpected(remove.error());
  edit.remove = *std::move(remove);
  auto accept = read_ids("--accept", options.accept, family);
  if (!accept) return tl::make_unexpected(accept.error());
  edit.accept = *std::move(accept);
  for (const std::string& text : options.rename) {
    const auto pair = read_rename(text, family);
    if (!pair) return tl::make_unexpected(pair.error());
    edit.rename.push_back(*pair);
  }
  if (edit.empty()) {
    return fail(ErrorKind::usage, "edit: nothing to do; name --remove, --rename or --accept");
  }
  return edit;
}

/// Those of the accepted that the map held as verified before.
std::vector<MarkerId> verified_before(const MarkerMap& map, const MapEdit& edit) {
  std::vector<MarkerId> verified;
  for (const MarkerId& id : edit.accept) {
    for (const SubMap& submap : map.submaps) {
      const MapMarker* marker = find_marker(submap, id);
      if (marker != nullptr && marker->verified) verified.push_back(id);
    }
  }
  std::sort(verified.begin(), verified.end());
  return verified;
}

std::string identity_text(const std::string& before, const std::string& after) {
  if (before == after) return fmt::format("map {} as before, and so is a quarantine of it", after);
  return fmt::format("map {}, before {}: a quarantine of that one does not hold for it", after,
                     before);
}

}  // namespace

Status run_edit(const EditOptions& options, std::ostream& out, std::ostream& notes) {
  if (auto writable = check_writable(options.output); !writable) return writable;
  const auto map = read_map_file(options.map);
  if (!map) return tl::make_unexpected(map.error());
  const auto edit = read_edit(options, map->families().only());
  if (!edit) return tl::make_unexpected(edit.error());
  const auto edited = edit_map(*map, options.map.string(), *edit);
  if (!edited) return tl::make_unexpected(edited.error());
  if (auto written = write_map_file(options.output, *edited); !written) return written;
  if (const auto before = verified_before(*map, *edit); !before.empty()) {
    fmt::print(notes, "note: verified before: {}\n",
               format_marker_ids(before, map->several_families()));
  }
  print_line(out, "{}: {} markers, {} removed, {} renamed, {} accepted; {}",
             options.output.string(), marker_ids(*edited).size(), edit->remove.size(),
             edit->rename.size(), edit->accept.size(),
             identity_text(content_hash(*map), content_hash(*edited)));
  return {};
}

}  // namespace waymark
