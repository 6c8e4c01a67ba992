#include "mapbuilder/commands/import_command.h"

#include "core/base/output_check.h"
#include "core/map/map_file.h"
#include "core/map/map_json.h"
#include "mapbuilder/commands/print_line.h"
#include "mapbuilder/import/lcm_capture.h"
#include "mapbuilder/import/recorded_file.h"
#ifdef WAYMARK_BAGS
#include "mapbuilder/import/bag_import.h"
#endif

namespace waymark {
namespace {

/// An option that was given although the input has nothing to do with it.
Status check_without(const ImportOptions& options, bool given, const char* option,
                     const char* what_it_is_for) {
  if (!given) return {};
  return fail(ErrorKind::usage, "{}: {} is for {}", options.input.string(), option, what_it_is_for);
}

Status check_without_topics(const ImportOptions& options) {
  constexpr const char* kRecordings = "recordings of ROS 2";
  if (auto fine = check_without(options, !options.cameras.empty(), "--camera", kRecordings);
      !fine) {
    return fine;
  }
  return check_without(options, options.every.has_value(), "--every", kRecordings);
}

Status import_map(const ImportOptions& options, std::ostream& out) {
  if (auto fine = check_without_topics(options); !fine) return fine;
  const bool described = options.description.rig || options.description.markers;
  if (auto fine = check_without(options, described, "--rig or --markers", "recordings"); !fine) {
    return fine;
  }
  if (auto fine = check_without(options, !options.channel.empty(), "--channel", "logs of LCM");
      !fine) {
    return fine;
  }
  if (auto spares = check_spares(options.output, {options.input}); !spares) return spares;
  if (auto writable = check_writable(options.output); !writable) return writable;
  const auto map = read_map_json(options.input);
  if (!map) return tl::make_unexpected(map.error());
  if (auto status = write_map_file(options.output, *map); !status) return status;
  std::size_t markers = 0;
  for (const SubMap& submap : map->submaps) markers += submap.markers.size();
  print_line(out, "{}: {} markers, content hash {}", options.output.string(), markers,
             content_hash(*map));
  return {};
}

Status import_log(const ImportOptions& options, Progress& progress, std::ostream& out,
                  std::ostream& notes) {
  if (auto fine = check_without_topics(options); !fine) return fine;
  return import_lcm_log({options.input, options.output, options.description, options.channel},
                        progress, out, notes);
}

Status import_recording(const ImportOptions& options, [[maybe_unused]] Progress& progress,
                        [[maybe_unused]] std::ostream& out, [[maybe_unused]] std::ostream& notes) {
  if (auto fine = check_without(options, !options.channel.empty(), "--channel", "logs of LCM");
      !fine) {
    return fine;
  }
#ifdef WAYMARK_BAGS
  return import_bag({options.input, options.output, options.description, options.cameras,
                     options.every.value_or(1)},
                    progress, out, notes);
#else
  return fail(ErrorKind::unavailable,
              "{}: this mapbuilder was built without what reads recordings of ROS 2 (WAYMARK_BAGS)",
              options.input.string());
#endif
}

}  // namespace

Status run_import(const ImportOptions& options, Progress& progress, std::ostream& out,
                  std::ostream& notes) {
  if (std::error_code ignored; std::filesystem::is_directory(options.input, ignored)) {
    return import_recording(options, progress, out, notes);
  }
  const auto kind = kind_of_file(options.input);
  if (!kind) return tl::make_unexpected(kind.error());
  switch (*kind) {
    case RecordedFile::other:
      return import_map(options, out);
    case RecordedFile::lcm_log:
      return import_log(options, progress, out, notes);
    case RecordedFile::mcap:
    case RecordedFile::sqlite:
    case RecordedFile::ros1_bag:
    case RecordedFile::zstd:
      return import_recording(options, progress, out, notes);
  }
  return {};
}

}  // namespace waymark
