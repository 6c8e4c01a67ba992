#include "core/capture/capture_folder.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <string_view>
#include <tuple>

#include "core/base/text_field.h"
#include "core/base/toml_text.h"
#include "core/camera/kalibr.h"
#include "core/capture/image_file.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// A larger tolerance would join frames of different places: at 1 m/s, 1 s is 1 m.
constexpr std::int64_t kMaxSyncTolerance_us = 1'000'000;

/// Spacing of images whose names are no stamps: far above any sync tolerance.
constexpr Stamp kAssumedSpacing = std::chrono::seconds(1);

Error folder_error(const fs::path& path, const std::error_code& why) {
  const bool denied = why == std::errc::permission_denied;
  return {denied ? ErrorKind::permission : ErrorKind::io,
          fmt::format("{}: can't list the folder: {}", path.string(), why.message())};
}

/// Entries of a folder by rising name, without hidden ones.
Expected<std::vector<fs::path>> list_folder(const fs::path& folder) {
  std::error_code why;
  std::vector<fs::path> entries;
  for (fs::directory_iterator entry(folder, why), end; !why && entry != end; entry.increment(why)) {
    if (!entry->path().filename().string().starts_with('.')) entries.push_back(entry->path());
  }
  if (why) return tl::make_unexpected(folder_error(folder, why));
  std::sort(entries.begin(), entries.end());
  return entries;
}

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
    for (const auto& [camera, folder] : *folders) {
      if (auto status = find_images_of(camera, folder); !status) return status;
    }
    if (capture_.images.empty() && !capture_.detections_csv) {
      return fail(
          ErrorKind::no_input,
          "{}: empty capture: neither images (cam0/<t_ns>.jpg, png or pgm) nor detections.csv",
          capture_.path.string());
    }
    return give_stamps();
  }

  struct CameraFolder {
    int camera;
    fs::path path;
  };

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

  Status find_images_of(int camera, const fs::path& folder) {
    const auto entries = list_folder(folder);
    if (!entries) return tl::make_unexpected(entries.error());
    const std::size_t before = capture_.images.size();
    std::size_t others = 0;
    for (const fs::path& entry : *entries) {
      if (!is_image_name(entry)) {
        ++others;
        continue;
      }
      capture_.images.push_back({camera, Stamp::zero(), entry});
    }
    if (others > 0) {
      capture_.notes.push_back(fmt::format("{}: {} of {} files are no jpg, png or pgm: left out",
                                           folder.string(), others, entries->size()));
    }
    if (capture_.images.size() == before) {
      capture_.notes.push_back(fmt::format("{}: no images", folder.string()));
    }
    return {};
  }

  Status give_stamps() {
    std::size_t stamped = 0;
    const ImageFile* without_stamp = nullptr;
    for (ImageFile& image : capture_.images) {
      if (const auto t_ns = parse_whole<std::int64_t>(image.path.stem().string())) {
        image.stamp = Stamp(*t_ns);
        ++stamped;
      } else if (without_stamp == nullptr) {
        without_stamp = &image;
      }
    }
    if (without_stamp != nullptr && (stamped > 0 || capture_.rig.cameras.size() > 1)) {
      return fail(ErrorKind::bad_data,
                  "{}: the name is no stamp; name images by their mid-exposure time in ns, all "
                  "cameras by one clock",
                  without_stamp->path.string());
    }
    if (without_stamp != nullptr) {
      capture_.stamps_from_names = false;
      for (std::size_t i = 0; i < capture_.images.size(); ++i) {
        capture_.images[i].stamp = kAssumedSpacing * static_cast<std::int64_t>(i);
      }
      capture_.notes.push_back(fmt::format(
          "{}: names are no stamps: images are taken in the order of their names, 1 s apart",
          capture_.path.string()));
    }
    return sort_images();
  }

  Status sort_images() {
    std::vector<ImageFile>& images = capture_.images;
    const auto key = [](const ImageFile& image) { return std::tie(image.stamp, image.camera); };
    std::sort(images.begin(), images.end(),
              [&](const ImageFile& a, const ImageFile& b) { return key(a) < key(b); });
    const auto twin = std::adjacent_find(
        images.begin(), images.end(),
        [&](const ImageFile& a, const ImageFile& b) { return key(a) == key(b); });
    if (twin != images.end()) {
      return fail(ErrorKind::bad_data,
                  "{} and {}: two images of one camera with one stamp; keep one",
                  twin->path.string(), std::next(twin)->path.filename().string());
    }
    return {};
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
