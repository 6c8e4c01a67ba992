#include "core/capture/capture_folder.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <set>
#include <string_view>

#include "core/base/text_field.h"
#include "core/base/toml_text.h"
#include "core/camera/kalibr.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// A larger tolerance would join frames of different places: at 1 m/s, 1 s is 1 m.
constexpr std::int64_t kMaxSyncTolerance_us = 1'000'000;

/// "cam" and a number.
bool is_camera_folder_name(std::string_view name) {
  constexpr std::string_view kPrefix = "cam";
  return name.starts_with(kPrefix) && parse_whole<unsigned>(name.substr(kPrefix.size()));
}

/// Reads one capture folder; each step fills a part of the result.
class FolderReader {
 public:
  explicit FolderReader(const fs::path& path) { capture_.path = path; }

  Expected<CaptureFolder> read() {
    std::error_code ignored;
    if (!fs::is_directory(capture_.path, ignored)) {
      return fail(ErrorKind::no_input, "{}: no such capture folder", capture_.path.string());
    }
    for (const auto step :
         {&FolderReader::read_rig, &FolderReader::read_catalog, &FolderReader::read_capture_toml,
          &FolderReader::find_tables, &FolderReader::find_images}) {
      if (auto status = (this->*step)(); !status) return tl::make_unexpected(status.error());
    }
    return std::move(capture_);
  }

 private:
  Status read_rig() {
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
    if (!exists(path)) return {};
    const auto table = read_toml(path);
    if (!table) return tl::make_unexpected(table.error());
    const auto wrong = [&](const toml::node& node, std::string_view what) {
      return fail(ErrorKind::bad_data, "{}: {}", toml_place(path.string(), node), what);
    };
    if (const toml::node* node = table->get("clock")) {
      const auto clock = node->value_or(std::string());
      if (clock != "realtime" && clock != "monotonic") {
        return wrong(*node, "clock must be \"realtime\" or \"monotonic\"");
      }
    }
    if (const toml::node* node = table->get("session")) {
      if (!node->is_string()) return wrong(*node, "session must be a text");
      capture_.session = node->value_or(std::string());
    }
    if (const toml::node* node = table->get("sync_tolerance_us")) {
      const auto tolerance_us = node->is_integer() ? node->value_or(std::int64_t{-1}) : -1;
      if (tolerance_us < 0 || tolerance_us > kMaxSyncTolerance_us) {
        return wrong(*node, "sync_tolerance_us must be a whole number from 0 to 1000000");
      }
      capture_.sync_tolerance = std::chrono::microseconds(tolerance_us);
    }
    return {};
  }

  Status find_tables() {
    if (auto path = capture_.path / "detections.csv"; exists(path)) capture_.detections_csv = path;
    if (auto path = capture_.path / "survey.toml"; exists(path)) capture_.survey_toml = path;
    return {};
  }

  Status find_images() {
    const auto folders = camera_folders();
    if (!folders) return tl::make_unexpected(folders.error());
    auto list = list_images(*folders);
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

  /// camK folders and rig.yaml must name the same cameras, unless there are no folders at all.
  Expected<std::vector<CameraFolder>> camera_folders() const {
    const auto entries = list_folder(capture_.path);
    if (!entries) return tl::make_unexpected(entries.error());
    std::set<std::string> present;
    std::error_code ignored;
    for (const fs::path& entry : *entries) {
      const std::string name = entry.filename().string();
      if (is_camera_folder_name(name) && fs::is_directory(entry, ignored)) present.insert(name);
    }
    std::vector<CameraFolder> folders;
    if (present.empty()) return folders;
    for (std::size_t camera = 0; camera < capture_.rig.cameras.size(); ++camera) {
      const std::string& name = capture_.rig.cameras[camera].name;
      if (present.erase(name) == 0) {
        return fail(ErrorKind::bad_data,
                    "{}: rig.yaml names {}, but there is no folder {}; remove the entry or add the "
                    "images",
                    capture_.path.string(), name, name);
      }
      folders.push_back({static_cast<int>(camera), capture_.path / name});
    }
    if (!present.empty()) {
      return fail(ErrorKind::bad_data,
                  "{}: folder {} has no entry in rig.yaml; add the camera or remove the folder",
                  capture_.path.string(), *present.begin());
    }
    return folders;
  }

  static bool exists(const fs::path& path) {
    std::error_code ignored;
    return fs::exists(path, ignored);
  }

  CaptureFolder capture_;
};

}  // namespace

Expected<CaptureFolder> open_capture_folder(const fs::path& path) {
  return FolderReader(path).read();
}

}  // namespace waymark
