#include "mapbuilder/diagnosis/image_look.h"

#include <algorithm>
#include <numeric>

#include "core/base/parallel.h"
#include "core/capture/image_file.h"
#include "core/detect/square_finder.h"
#include "core/marker/marker_outline.h"
#include "core/marker/nested_families.h"

namespace waymark {
namespace {

/// Images per camera that are looked at: where it sees markers enough, and where it does not.
constexpr std::size_t kFew = 4;
constexpr std::size_t kMany = 12;
/// Markers per image that are enough.
constexpr double kEnough = 2;

/// A place in the image that needs no other explanation.
struct Explained {
  Eigen::Vector2d centre_px;
  double side_px;
};

Explained place_of(const ImageCorners& corners) {
  return {centre_of(corners), mean_side_px(corners)};
}

/// Whether a square stands on or around a known one: its outline's other side, its paper.
bool stands_on(const Explained& known, const Explained& square) {
  return (known.centre_px - square.centre_px).norm() <
         0.3 * std::min(known.side_px, square.side_px);
}

/// Whether it stands in a known one: some of its cells.
bool stands_in(const Explained& known, const Explained& square) {
  const double farthest_px = (known.centre_px - square.centre_px).norm() + 0.5 * square.side_px;
  return farthest_px < 0.6 * known.side_px;
}

bool is_any(const std::vector<Explained>& known, const Explained& square) {
  return std::any_of(known.begin(), known.end(),
                     [&](const Explained& one) { return stands_on(one, square); });
}

bool is_explained(const Explained& square, const std::vector<Explained>& explained) {
  return std::any_of(explained.begin(), explained.end(), [&](const Explained& known) {
    return stands_on(known, square) || stands_in(known, square);
  });
}

bool points_down(const ImageCorners& square, int top_left) {
  const auto corner = [&](int i) { return square[static_cast<std::size_t>((top_left + i) % 4)]; };
  return (corner(0) + corner(1) - corner(2) - corner(3)).y() > 0;
}

/// Looks at images of one capture.
class Looker {
 public:
  explicit Looker(const MarkerCatalog& catalog) : catalog_(catalog) {
    for (const auto& entry : catalog.entries()) {
      auto& stated = entry.inverted ? stated_inverted_ : stated_;
      stated[largest_beginning_with(entry.family)] = &entry;
    }
  }

  [[nodiscard]] CameraLook look(const GrayImage& image,
                                const std::vector<Detection>& detections) const {
    CameraLook look;
    look.images = 1;
    look.mean_grey = std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) /
                     static_cast<double>(image.pixels.size());
    std::vector<Explained> explained;
    for (const Detection& detection : detections) explained.push_back(place_of(detection.corners));
    std::vector<std::pair<ImageCorners, SquareLook>> squares;
    for (const ImageCorners& square : find_squares(image.view())) {
      squares.emplace_back(square, reader_.read(image.view(), square));
    }
    look.squares = static_cast<int>(squares.size());
    const std::vector<Explained> found = explained;
    for (const auto& [square, seen] : squares) {
      if (take_stated(stated_, square, seen, is_any(found, place_of(square)), look)) {
        explained.push_back(place_of(square));
      }
    }
    for (const auto& [square, seen] : squares) {
      if (is_explained(place_of(square), explained)) continue;
      count_others(seen, {}, look);
      if (!seen.readings.empty()) explained.push_back(place_of(square));
    }
    for (const ImageCorners& area : find_code_areas(image.view())) {
      if (is_explained(place_of(area), explained)) continue;
      const SquareLook seen = reader_.read_inside(image.view(), area);
      count_others(seen, {{}, false, true}, look);
      if (!seen.readings.empty()) explained.push_back(place_of(area));
    }
    GrayImage inverted = image;
    for (std::uint8_t& grey : inverted.pixels) grey = static_cast<std::uint8_t>(255 - grey);
    for (const ImageCorners& square : find_squares(inverted.view())) {
      const SquareLook seen = reader_.read(inverted.view(), square);
      const bool is_found = is_any(found, place_of(square));
      if (take_stated(stated_inverted_, square, seen, is_found, look)) continue;
      if (is_explained(place_of(square), explained)) continue;
      count_others(seen, {{}, true, false}, look);
    }
    return look;
  }

 private:
  using Stated = std::map<Family, const MarkerCatalog::FamilyEntry*>;  ///< by representative

  /// Whether the square shows a marker of a stated family; `found`: the detector has found one
  /// there, whose border may still be cut.
  bool take_stated(const Stated& stated, const ImageCorners& square, const SquareLook& seen,
                   bool found, CameraLook& look) const {
    for (const SquareReading& reading : seen.readings) {
      const auto entry = stated.find(reading.form.family);
      if (entry == stated.end() || reading.form.mirrored) continue;
      if (reading.form.other_border && !found) continue;
      const MarkerId id{entry->second->family, reading.number};
      // A larger family's code, where only its beginning is stated.
      if (reading.number >= traits(id.family).id_count) continue;
      if (catalog_.size_m(id)) {
        // What the detector has left out (too small, half covered) needs no other reading.
        ++look.stated;
        look.stated_numbers.insert(reading.number);
        if (points_down(square, reading.first_corner)) ++look.upside_down;
        if (reading.form.other_border) {
          ++look.stated_cut;
          look.cut_cells += reading.border_cells;
        }
      } else if (!entry->second->ignored.contains(reading.number)) {
        ++look.unlisted[id];
      }
      return true;
    }
    return false;
  }

  /// Counts what a square reads as, and what it could, beside how it was looked at.
  static void count_others(const SquareLook& seen, OtherForm form, CameraLook& look) {
    for (const SquareReading& reading : seen.readings) {
      form.form = reading.form;
      FormCount& count = look.others[form];
      ++count.squares;
      count.numbers.insert(reading.number);
      count.border_cells += reading.border_cells;
      if (reading.wrong_bits > 0) continue;
      ++count.exact;
      count.exact_numbers.insert(reading.number);
    }
    for (const Family family : SquareReader::families()) {
      for (const bool mirrored : {false, true}) {
        for (const bool other_border : {false, true}) {
          form.form = {family, mirrored, other_border};
          if (seen.could_show(form.form)) ++look.others[form].could;
        }
      }
    }
  }

  const MarkerCatalog& catalog_;
  Stated stated_;
  Stated stated_inverted_;  ///< printed white for black
  SquareReader reader_;
};

void add(const CameraLook& one, CameraLook& all) {
  all.images += one.images;
  all.mean_grey += one.mean_grey;  // a sum until the end
  all.squares += one.squares;
  all.stated += one.stated;
  all.stated_cut += one.stated_cut;
  all.cut_cells += one.cut_cells;
  all.upside_down += one.upside_down;
  all.stated_numbers.insert(one.stated_numbers.begin(), one.stated_numbers.end());
  for (const auto& [id, count] : one.unlisted) all.unlisted[id] += count;
  for (const auto& [form, count] : one.others) {
    FormCount& sum = all.others[form];
    sum.squares += count.squares;
    sum.exact += count.exact;
    sum.could += count.could;
    sum.border_cells += count.border_cells;
    sum.numbers.insert(count.numbers.begin(), count.numbers.end());
    sum.exact_numbers.insert(count.exact_numbers.begin(), count.exact_numbers.end());
  }
}

/// Evenly spread over what there is.
std::vector<std::size_t> sample_of(const std::vector<std::size_t>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<std::size_t> sample;
  for (std::size_t i = 0; i < most; ++i) {
    sample.push_back(all[(2 * i + 1) * all.size() / (2 * most)]);
  }
  return sample;
}

/// An image to look at, and what the detector found in it.
struct Task {
  const ImageFile* file = nullptr;
  const std::vector<Detection>* detections = nullptr;
};

std::vector<Task> tasks_for(const CaptureFolder& folder, const DetectedCapture& detected) {
  static const std::vector<Detection> kNone;
  std::map<std::pair<int, Stamp>, const std::vector<Detection>*> found;
  std::vector<std::size_t> markers(folder.rig.cameras.size(), 0);
  for (const ImageDetections& image : detected.images) {
    found[{image.camera, image.stamp}] = &image.detections;
    markers[static_cast<std::size_t>(image.camera)] += image.detections.size();
  }
  std::vector<std::vector<std::size_t>> of_camera(folder.rig.cameras.size());
  for (std::size_t i = 0; i < folder.images.size(); ++i) {
    of_camera[static_cast<std::size_t>(folder.images[i].camera)].push_back(i);
  }
  std::vector<Task> tasks;
  for (std::size_t camera = 0; camera < of_camera.size(); ++camera) {
    const auto& images = of_camera[camera];
    const bool enough =
        static_cast<double>(markers[camera]) >= kEnough * static_cast<double>(images.size());
    if (folder.detections_csv && markers[camera] > 0) continue;
    for (const std::size_t i : sample_of(images, enough ? kFew : kMany)) {
      const ImageFile& file = folder.images[i];
      const auto known = found.find({file.camera, file.stamp});
      tasks.push_back({&file, known == found.end() ? &kNone : known->second});
    }
  }
  return tasks;
}

}  // namespace

std::vector<CameraLook> look_at_images(const CaptureFolder& folder, const DetectedCapture& detected,
                                       int threads, Progress& progress) {
  std::vector<CameraLook> looks;
  for (const RigCamera& camera : folder.rig.cameras) looks.emplace_back().camera = camera.name;
  const std::vector<Task> tasks = tasks_for(folder, detected);
  if (tasks.empty()) return looks;
  progress.begin("looking at images again", tasks.size());
  const Looker looker(folder.catalog);
  std::vector<CameraLook> results(tasks.size());
  parallel_for(tasks.size(), effective_threads(threads), [&](std::size_t i) {
    const ImageFile& file = *tasks[i].file;
    const CameraParameters& p =
        folder.rig.cameras[static_cast<std::size_t>(file.camera)].model.parameters();
    // What can't be read, or is of another size, has been said.
    const auto loaded = read_gray_image(file.path, ImageSize{p.width_px, p.height_px});
    if (loaded) results[i] = looker.look(loaded->image, *tasks[i].detections);
  });
  progress.end();
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    add(results[i], looks[static_cast<std::size_t>(tasks[i].file->camera)]);
  }
  for (CameraLook& look : looks) {
    if (look.images > 0) look.mean_grey /= static_cast<double>(look.images);
  }
  return looks;
}

}  // namespace waymark
