#include "mapbuilder/import/described_capture.h"

#include <fmt/ostream.h>

#include "core/base/atomic_file.h"
#include "core/base/growing_folder.h"
#include "core/base/is_there.h"
#include "core/camera/kalibr.h"
#include "core/marker/marker_catalog.h"

namespace waymark {
namespace {

/// To the byte: a refined rig says more than the numbers that are read of it.
Status copy_bytes(const std::filesystem::path& from, const std::filesystem::path& to) {
  const auto content = read_file(from);
  if (!content) return tl::make_unexpected(content.error());
  return write_new_file(to, *content);
}

}  // namespace

Status describe_capture(const CaptureDescription& description,
                        const std::filesystem::path& folder) {
  if (description.rig) {
    if (const auto rig = read_camchain(*description.rig); !rig) {
      return tl::make_unexpected(rig.error());
    }
    if (auto copied = copy_bytes(*description.rig, folder / "rig.yaml"); !copied) return copied;
  }
  if (description.markers) {
    if (const auto catalog = read_marker_catalog(*description.markers); !catalog) {
      return tl::make_unexpected(catalog.error());
    }
    if (auto copied = copy_bytes(*description.markers, folder / "markers.toml"); !copied)
      return copied;
  }
  return {};
}

void tell_what_is_missing(const std::filesystem::path& capture, std::ostream& notes) {
  if (!is_there(capture / "rig.yaml")) {
    fmt::print(notes,
               "note: {}: put rig.yaml there (Kalibr camchain), or let mapbuilder calibrate find "
               "it\n",
               in_one_line(capture.string()));
  }
  if (!is_there(capture / "markers.toml")) {
    fmt::print(notes,
               "note: {}: put markers.toml there: families and sizes of the markers, as mapbuilder "
               "print writes it\n",
               in_one_line(capture.string()));
  }
}

}  // namespace waymark
