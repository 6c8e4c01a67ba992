#include "core/capture/rig_of_frames.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/base/is_there.h"
#include "core/base/text_field.h"
#include "core/camera/image_sizes.h"
#include "core/capture/capture_files.h"
#include "core/capture/detections_csv.h"
#include "core/capture/image_file.h"
#include "core/capture/image_list.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// More cameras are on no rig.
constexpr int kMostCameras = 64;

/// Sensors that cameras on vehicles have, and binned ones; lying.
constexpr std::array<std::pair<int, int>, 30> kSensorSizes{
    {{320, 240},   {640, 400},   {640, 480},   {752, 480},   {800, 600},   {848, 480},
     {960, 540},   {1024, 768},  {1224, 1024}, {1280, 720},  {1280, 800},  {1280, 960},
     {1280, 1024}, {1440, 1080}, {1600, 1200}, {1640, 1232}, {1920, 1080}, {1920, 1200},
     {2028, 1520}, {2048, 1536}, {2048, 2048}, {2304, 1296}, {2448, 2048}, {2592, 1944},
     {3280, 2464}, {3840, 2160}, {4000, 3000}, {4056, 3040}, {4096, 2160}, {4608, 2592}}};

std::string name_of_camera(int number) { return fmt::format("cam{}", number); }

Expected<RigCamera> guessed_camera(const std::string& name, ImageSize size) {
  CameraParameters parameters;
  parameters.width_px = static_cast<int>(size.width_px);
  parameters.height_px = static_cast<int>(size.height_px);
  parameters.fu_px = parameters.fv_px = std::max(parameters.width_px, parameters.height_px);
  parameters.pu_px = 0.5 * (parameters.width_px - 1);
  parameters.pv_px = 0.5 * (parameters.height_px - 1);
  auto model = CameraModel::create(parameters);
  if (!model) return tl::make_unexpected(model.error());
  return RigCamera{name, *std::move(model), Rigid3(), "", "", {}, {}, {}, {}, SigmaSource::hand};
}

/// The size of the first image in a camera's folder whose header can be read.
Expected<ImageSize> size_of_images(const fs::path& folder) {
  const auto entries = list_folder(folder);
  if (!entries) return tl::make_unexpected(entries.error());
  std::optional<Error> first_error;
  for (const fs::path& entry : *entries) {
    if (!is_image_name(entry)) continue;
    auto size = read_image_size(entry);
    if (size && check_image_size(*size, {})) return *size;
    if (!size && !first_error) first_error = size.error();
  }
  if (first_error) return tl::make_unexpected(*first_error);
  return fail(ErrorKind::bad_data, "{}: no image tells the camera's size", folder.string());
}

/// The numbers of the camera folders; bad_data where they have gaps.
Expected<int> count_camera_folders(const fs::path& parent) {
  const auto entries = list_folder(parent);
  if (!entries) return tl::make_unexpected(entries.error());
  std::error_code ignored;
  int count = 0;
  int largest = -1;
  for (const fs::path& entry : *entries) {
    const std::string name = entry.filename().string();
    if (!is_camera_folder_name(name) || !fs::is_directory(entry, ignored)) continue;
    const auto number = parse_whole<unsigned>(name.substr(3));
    if (*number >= kMostCameras || name != name_of_camera(static_cast<int>(*number))) {
      return fail(ErrorKind::bad_data, "{}: cameras are cam0, cam1, … cam{}", entry.string(),
                  kMostCameras - 1);
    }
    ++count;
    largest = std::max(largest, static_cast<int>(*number));
  }
  if (largest + 1 == count) return count;
  return fail(ErrorKind::bad_data,
              "{}: cam{} but only {} camera folders; they are numbered from cam0 without gaps",
              parent.string(), largest, count);
}

bool holds_images(const fs::path& folder) {
  const auto entries = list_folder(folder);
  return entries && std::any_of(entries->begin(), entries->end(),
                                [](const fs::path& entry) { return is_image_name(entry); });
}

/// By images; no cameras where there are none.
Expected<Rig> rig_of_images(const fs::path& parent) {
  Rig rig;
  if (!is_there(parent)) return rig;
  const auto folders = count_camera_folders(parent);
  if (!folders) return tl::make_unexpected(folders.error());
  std::vector<fs::path> places;
  for (int k = 0; k < *folders; ++k) places.push_back(parent / name_of_camera(k));
  if (places.empty() && parent.filename() == "images" && holds_images(parent)) {
    places.push_back(parent);
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto size = size_of_images(places[k]);
    if (!size) return tl::make_unexpected(size.error());
    auto camera = guessed_camera(name_of_camera(static_cast<int>(k)), *size);
    if (!camera) return tl::make_unexpected(camera.error());
    rig.cameras.push_back(*std::move(camera));
  }
  return rig;
}

/// The least sensor on which all corners lie; where there is none, what just holds them.
ImageSize sensor_that_holds(const Eigen::Vector2d& largest_px) {
  const auto holds = [&](int width, int height) {
    return largest_px.x() < width && largest_px.y() < height;
  };
  std::optional<ImageSize> least;
  for (const auto& [width, height] : kSensorSizes) {
    for (const auto& [w, h] : {std::pair(width, height), std::pair(height, width)}) {
      if (holds(w, h) && (!least || std::int64_t{w} * h < least->width_px * least->height_px)) {
        least = ImageSize{w, h};
      }
    }
  }
  if (least) return *least;
  constexpr double kStep = 16;
  return {static_cast<std::int64_t>(kStep * std::ceil((largest_px.x() + 1) / kStep)),
          static_cast<std::int64_t>(kStep * std::ceil((largest_px.y() + 1) / kStep))};
}

/// A rig whose cameras have every name that detections may use.
Expected<Rig> rig_of_every_name() {
  Rig rig;
  for (int k = 0; k < kMostCameras; ++k) {
    auto camera = guessed_camera(name_of_camera(k), {640, 480});
    if (!camera) return tl::make_unexpected(camera.error());
    rig.cameras.push_back(*std::move(camera));
  }
  return rig;
}

Expected<Rig> rig_of_detections(const FramePlaces& places, const MarkerCatalog& catalog,
                                std::vector<std::string>& notes) {
  const auto every = rig_of_every_name();
  if (!every) return tl::make_unexpected(every.error());
  const auto table = read_detections_csv(*places.detections_csv, *every, catalog, places.monotonic);
  if (!table) return tl::make_unexpected(table.error());
  std::map<int, Eigen::Vector2d> largest_px;
  for (const ImageDetections& image : table->images) {
    Eigen::Vector2d& largest =
        largest_px.try_emplace(image.camera, Eigen::Vector2d::Zero()).first->second;
    for (const Detection& detection : image.detections) {
      for (const Eigen::Vector2d& corner : detection.corners) largest = largest.cwiseMax(corner);
    }
  }
  // Cameras of a rig are alike as a rule, and some see markers farther out than others.
  Eigen::Vector2d largest_of_all_px = Eigen::Vector2d::Zero();
  for (const auto& [number, largest] : largest_px) {
    largest_of_all_px = largest_of_all_px.cwiseMax(largest);
  }
  const ImageSize size = sensor_that_holds(largest_of_all_px);
  Rig rig;
  for (const auto& [number, largest] : largest_px) {
    if (number != static_cast<int>(rig.cameras.size())) {
      return fail(ErrorKind::bad_data, "{}: cam{} without a cam{}; cameras are numbered from 0",
                  places.detections_csv->string(), number, rig.cameras.size());
    }
    auto camera = guessed_camera(name_of_camera(number), size);
    if (!camera) return tl::make_unexpected(camera.error());
    rig.cameras.push_back(*std::move(camera));
  }
  notes.push_back(fmt::format(
      "{}: no image tells the cameras' size; taken for {}×{}, the least sensor that holds all "
      "corners; state resolution in a rig.yaml if that is wrong",
      places.detections_csv->string(), size.width_px, size.height_px));
  return rig;
}

}  // namespace

Expected<Rig> rig_of_frames(const FramePlaces& places, const MarkerCatalog& catalog,
                            std::vector<std::string>& notes) {
  auto rig = rig_of_images(places.images);
  if (!rig) return rig;
  if (rig->cameras.empty() && places.detections_csv) {
    rig = rig_of_detections(places, catalog, notes);
    if (!rig) return rig;
  }
  if (rig->cameras.empty()) {
    return fail(ErrorKind::no_input,
                "{}: no cameras: neither images (cam0/<t_ns>.jpg, png or pgm) nor detections",
                places.images.string());
  }
  rig->has_extrinsics = rig->cameras.size() == 1;
  if (auto sized = check_image_sizes(*rig, places.images.string()); !sized) {
    return tl::make_unexpected(sized.error());
  }
  return rig;
}

}  // namespace waymark
