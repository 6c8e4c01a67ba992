#include "core/capture/capture_folder.h"

#include <iterator>

#include "core/base/is_there.h"
#include "core/base/toml_fields.h"
#include "core/camera/kalibr.h"
#include "core/capture/rig_of_frames.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// Reads one capture folder; each step fills a part of the result.
class FolderReader {
 public:
  FolderReader(const fs::path& path, RigFile rig_file) : rig_file_(rig_file) {
    capture_.path = path;
  }

  Expected<CaptureFolder> read() {
    std::error_code ignored;
    if (!fs::is_directory(capture_.path, ignored)) {
      return absent(capture_.path, "no such capture folder");
    }
    for (const auto step :
         {&FolderReader::read_rig, &FolderReader::read_catalog, &FolderReader::read_capture_toml,
          &FolderReader::find_tables, &FolderReader::guess_rig, &FolderReader::find_images}) {
      if (auto status = (this->*step)(); !status) return tl::make_unexpected(status.error());
    }
    return std::move(capture_);
  }

 private:
  Status read_rig() {
    if (rig_file_ == RigFile::optional && !is_there(capture_.path / "rig.yaml")) return {};
    auto loaded = read_camchain(capture_.path / "rig.yaml");
    if (!loaded) return tl::make_unexpected(loaded.error());
    capture_.rig = std::move(loaded->rig);
    capture_.notes = std::move(loaded->notes);
    return {};
  }

  Status read_catalog() {
    auto catalog = read_marker_catalog(capture_.path / "markers.toml");
    if (!catalog) return tl::make_unexpected(catalog.error());
    capture_.catalog = std::move(*catalog);
    return {};
  }

  Status read_capture_toml() {
    const fs::path path = capture_.path / "capture.toml";
    if (!is_there(path)) return {};
    const auto table = read_toml(path);
    if (!table) return tl::make_unexpected(table.error());
    TomlFields fields(*table, path.string());
    capture_.monotonic = fields.choice("clock", {"realtime", "monotonic"}, 0) == 1;
    capture_.session = fields.text("session", "");
    capture_.sync_tolerance = std::chrono::microseconds(
        fields.integer("sync_tolerance_us", static_cast<int>(kSyncTolerance_us.low),
                       static_cast<int>(kSyncTolerance_us.high),
                       static_cast<int>(kDefaultSyncTolerance / std::chrono::microseconds(1))));
    // Told to people only.
    (void)fields.text("codec", "");
    (void)fields.text("software", "");
    fields.allow("date_known");  // asked for by what deletes recordings for their age
    return fields.finish();
  }

  Status find_tables() {
    if (auto path = capture_.path / "detections.csv"; is_there(path))
      capture_.detections_csv = path;
    if (auto path = capture_.path / "survey.toml"; is_there(path)) capture_.survey_toml = path;
    return {};
  }

  Status guess_rig() {
    if (!capture_.rig.cameras.empty()) return {};
    auto rig = rig_of_frames({capture_.path, capture_.detections_csv, capture_.monotonic},
                             capture_.catalog, capture_.notes);
    if (!rig) return tl::make_unexpected(rig.error());
    capture_.rig = *std::move(rig);
    return {};
  }

  Status find_images() {
    const auto folders = find_camera_folders(capture_.path, capture_.rig);
    if (!folders) return tl::make_unexpected(folders.error());
    auto list = list_images(*folders, capture_.monotonic);
    if (!list) return tl::make_unexpected(list.error());
    if (list->images.empty() && !capture_.detections_csv) {
      return fail(
          ErrorKind::no_input,
          "{}: empty capture: neither images (cam0/<t_ns>.jpg, png or pgm) nor detections.csv",
          capture_.path.string());
    }
    capture_.images = std::move(list->images);
    capture_.stamps_from_names = list->stamps_from_names;
    std::move(list->notes.begin(), list->notes.end(), std::back_inserter(capture_.notes));
    return {};
  }

  RigFile rig_file_;
  CaptureFolder capture_;
};

}  // namespace

Expected<CaptureFolder> open_capture_folder(const fs::path& path, RigFile rig_file) {
  return FolderReader(path, rig_file).read();
}

}  // namespace waymark
