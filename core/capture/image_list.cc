#include "core/capture/image_list.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <string_view>
#include <tuple>

#include "core/base/text_field.h"
#include "core/capture/capture_files.h"
#include "core/capture/foreign_format.h"
#include "core/capture/image_file.h"
#include "core/capture/stamp_doubt.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// Spacing of images whose names are no stamps: far above any sync tolerance.
constexpr Stamp kAssumedSpacing = std::chrono::seconds(1);

/// Of a folder that holds no image that is read.
Status check_no_foreign_images(const CameraFolder& folder, const std::vector<fs::path>& entries) {
  for (const fs::path& entry : entries) {
    const std::string_view format = foreign_format_of_name(entry);
    if (format.empty()) continue;
    return fail(Cause::format,
                "{}: images in {}, which is not read; convert them to PNG, for instance: mogrify "
                "-format png {}/*{}",
                folder.path.string(), format, folder.path.string(), entry.extension().string());
  }
  return {};
}

Status add_images_of(const CameraFolder& folder, ImageList& list) {
  const auto entries = list_folder(folder.path);
  if (!entries) return tl::make_unexpected(entries.error());
  std::size_t others = 0;
  for (const fs::path& entry : *entries) {
    if (is_image_name(entry)) {
      list.images.push_back({folder.camera, Stamp::zero(), entry});
    } else {
      ++others;
    }
  }
  if (others == entries->size()) {
    if (auto known = check_no_foreign_images(folder, *entries); !known) return known;
    list.notes.push_back(fmt::format("{}: no images", folder.path.string()));
  }
  if (others > 0) {
    list.notes.push_back(fmt::format("{}: {} of {} files are no jpg, png or pgm: left out",
                                     folder.path.string(), others, entries->size()));
  }
  return {};
}

/// The number that a name is, as a stamp; nullopt for every other name.
std::optional<Stamp> stamp_of_name(const fs::path& path) {
  const auto t_ns = parse_whole<std::int64_t>(path.stem().string());
  if (!t_ns || !is_in_range(Stamp(*t_ns))) return std::nullopt;
  return Stamp(*t_ns);
}

/// The images of one camera in the order of their names, 1 s apart.
void take_in_order(ImageList& list, const std::string& why) {
  // Numbers by what they are: 9 before 10.
  std::stable_sort(list.images.begin(), list.images.end(),
                   [](const ImageFile& a, const ImageFile& b) { return a.stamp < b.stamp; });
  for (std::size_t i = 0; i < list.images.size(); ++i) {
    list.images[i].stamp = kAssumedSpacing * static_cast<std::int64_t>(i);
  }
  list.stamps_from_names = false;
  list.notes.push_back(
      fmt::format("{}: {}: images are taken in the order of their names, 1 s apart",
                  list.images.front().path.parent_path().string(), why));
}

/// From the names; where they say nothing, from their order.
Status give_stamps(ImageList& list, bool several_cameras, bool monotonic) {
  constexpr std::string_view kWhatToDo =
      "name images by their mid-exposure time in ns, all cameras by one clock";
  std::vector<StampedImage> stamped;
  const ImageFile* without_stamp = nullptr;
  for (ImageFile& image : list.images) {
    if (const auto stamp = stamp_of_name(image.path)) {
      image.stamp = *stamp;
      stamped.push_back({image.camera, *stamp});
    } else if (without_stamp == nullptr) {
      without_stamp = &image;
    }
  }
  if (without_stamp != nullptr && (several_cameras || !stamped.empty())) {
    return fail(Cause::stamps, "{}: the name is no stamp; {}", without_stamp->path.string(),
                kWhatToDo);
  }
  if (without_stamp != nullptr) {
    take_in_order(list, "names are no stamps");
    return {};
  }
  if (const auto doubt = doubt_of_span(stamped)) {
    return fail(Cause::stamps, "{}: by the images' names {}",
                list.images.front().path.parent_path().string(), *doubt);
  }
  const auto doubt = doubt_of_stamps(stamped, monotonic);
  if (!doubt) return {};
  if (several_cameras) {
    return fail(Cause::stamps, "{}: by the images' names {}",
                list.images.front().path.parent_path().string(), *doubt);
  }
  take_in_order(list, "names are no stamps (" + *doubt + ")");
  return {};
}

Status sort_by_stamp(std::vector<ImageFile>& images) {
  const auto key = [](const ImageFile& image) { return std::tie(image.stamp, image.camera); };
  std::stable_sort(images.begin(), images.end(),
                   [&](const ImageFile& a, const ImageFile& b) { return key(a) < key(b); });
  const auto twin =
      std::adjacent_find(images.begin(), images.end(),
                         [&](const ImageFile& a, const ImageFile& b) { return key(a) == key(b); });
  if (twin != images.end()) {
    return fail(ErrorKind::bad_data, "{} and {}: two images of one camera with one stamp; keep one",
                twin->path.string(), std::next(twin)->path.filename().string());
  }
  return {};
}

}  // namespace

Expected<std::vector<CameraFolder>> find_camera_folders(const fs::path& parent, const Rig& rig) {
  const auto entries = list_folder(parent);
  if (!entries) return tl::make_unexpected(entries.error());
  std::set<std::string> present;
  std::error_code ignored;
  for (const fs::path& entry : *entries) {
    const std::string name = entry.filename().string();
    if (is_camera_folder_name(name) && fs::is_directory(entry, ignored)) present.insert(name);
  }
  std::vector<CameraFolder> folders;
  if (present.empty()) return folders;
  for (std::size_t camera = 0; camera < rig.cameras.size(); ++camera) {
    const std::string& name = rig.cameras[camera].name;
    if (present.erase(name) == 0) {
      return fail(ErrorKind::bad_data,
                  "{}: rig.yaml names {}, but there is no folder {}; remove the entry or add the "
                  "images",
                  parent.string(), name, name);
    }
    folders.push_back({static_cast<int>(camera), parent / name});
  }
  if (!present.empty()) {
    return fail(ErrorKind::bad_data,
                "{}: folder {} has no entry in rig.yaml; add the camera or remove the folder",
                parent.string(), *present.begin());
  }
  return folders;
}

Expected<ImageList> list_images(const std::vector<CameraFolder>& folders, bool monotonic) {
  ImageList list;
  for (const CameraFolder& folder : folders) {
    if (auto status = add_images_of(folder, list); !status) {
      return tl::make_unexpected(status.error());
    }
  }
  if (auto status = give_stamps(list, folders.size() > 1, monotonic); !status) {
    return tl::make_unexpected(status.error());
  }
  if (auto status = sort_by_stamp(list.images); !status) {
    return tl::make_unexpected(status.error());
  }
  return list;
}

Expected<std::vector<fs::path>> list_folder(const fs::path& folder) {
  std::error_code why;
  std::vector<fs::path> entries;
  for (fs::directory_iterator entry(folder, why), end; !why && entry != end; entry.increment(why)) {
    if (!entry->path().filename().string().starts_with('.')) entries.push_back(entry->path());
  }
  if (why) {
    const bool denied = why == std::errc::permission_denied;
    return fail(denied ? ErrorKind::permission : ErrorKind::io, "{}: can't list the folder: {}",
                folder.string(), why.message());
  }
  std::sort(entries.begin(), entries.end());
  return entries;
}

}  // namespace waymark
