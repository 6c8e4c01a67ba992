#include <algorithm>
#include <cmath>

#include "bench/cause_variants/faults.h"

namespace waymark::bench {
namespace {

using simulator::Random;

void refused(Variant& variant, Cause cause) {
  variant.truth.causes = {cause};
  variant.truth.exits = {65};
}

/// Seconds, milliseconds, microseconds, frame numbers, or all zero.
bool stamps(Variant& variant, Random& random) {
  World& world = variant.world();
  const auto kind = random.below(5);
  constexpr std::int64_t kPer[] = {1'000'000'000, 1'000'000, 1'000};
  for (std::size_t set = 0; set < world.sets; ++set) {
    for (Stamp& stamp : world.stamps[set]) {
      stamp = kind < 3    ? Stamp(stamp.count() / kPer[kind])
              : kind == 3 ? Stamp(static_cast<std::int64_t>(set))
                          : Stamp(0);
    }
  }
  refused(variant, Cause::stamps);
  return true;
}

/// Each row's fields, after the head.
template <typename Change>
std::function<void(std::string&)> on_rows(Change change) {
  return [change](std::string& csv) {
    std::string changed = csv.substr(0, csv.find('\n') + 1);
    for (std::size_t at = changed.size(); at < csv.size();) {
      const std::size_t end = csv.find('\n', at);
      changed += change(csv.substr(at, end - at)) + "\n";
      at = end + 1;
    }
    csv = changed;
  };
}

void in_utf16(std::string& csv) {
  std::string wide = "\xff\xfe";
  for (const char c : csv) (wide += c) += '\0';
  csv = wide;
}

/// Semicolons and decimal commas, UTF-16, rows twice, corners as AprilTag has them, y up.
bool csv(Variant& variant, Random& random) {
  refused(variant, Cause::csv);
  switch (random.below(5)) {
    case 0:
      variant.on_csv = [](std::string& text) {
        for (char& c : text) c = c == ',' ? ';' : c == '.' ? ',' : c;
      };
      return true;
    case 1:
      variant.on_csv = in_utf16;
      return true;
    case 2:
      variant.on_csv = on_rows([](const std::string& row) { return row + "\n" + row; });
      return true;
    case 3:
      variant.on_images.emplace_back([](std::vector<ImageDetections>& images) {
        for (ImageDetections& image : images) {
          for (Detection& d : image.detections) std::reverse(d.corners.begin(), d.corners.end());
        }
      });
      return true;
    default:
      variant.truth.causes.insert(Cause::mirrored);
      variant.on_images.emplace_back(
          [world = variant.world()](std::vector<ImageDetections>& images) {
            for (ImageDetections& image : images) {
              const auto& lens = world.rig.cameras[static_cast<std::size_t>(image.camera)].model;
              for (Detection& d : image.detections) {
                for (auto& corner : d.corners) {
                  corner.y() = lens.parameters().height_px - 1 - corner.y();
                }
              }
            }
          });
      return true;
  }
}

/// One camera's calibration as ROS or OpenCV write it, with five coefficients or eight.
bool format(Variant& variant, Random& random) {
  const World& world = variant.world();
  if (world.kind != RigKind::mono) return false;
  const CameraParameters p = world.rig.cameras.front().model.parameters();
  const bool ros = random.uniform() < 0.5;
  const std::string more = random.uniform() < 0.5 ? "" : ", 0, 0, 0";
  const std::string camera =
      fmt::format("[{}, 0.0, {}, 0.0, {}, {}, 0.0, 0.0, 1.0]", p.fu_px, p.pu_px, p.fv_px, p.pv_px);
  const std::string lens =
      fmt::format("[{}, {}, {}, {}, 0{}]", p.coefficients[0], p.coefficients[1], p.coefficients[2],
                  p.coefficients[3], more);
  variant.on_rig = [=](std::string& text) {
    text = ros ? fmt::format(
                     "image_width: {}\nimage_height: {}\ncamera_name: front\n"
                     "camera_matrix:\n  rows: 3\n  cols: 3\n  data: {}\n"
                     "distortion_model: plumb_bob\n"
                     "distortion_coefficients:\n  rows: 1\n  cols: {}\n  data: {}\n",
                     p.width_px, p.height_px, camera, more.empty() ? 5 : 8, lens)
               : fmt::format(
                     "%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\n"
                     "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
                     "   data: {}\n"
                     "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: {}\n"
                     "   dt: d\n   data: {}\n",
                     p.width_px, p.height_px, camera, more.empty() ? 5 : 8, lens);
  };
  variant.truth.causes = {Cause::format};
  variant.truth.at_least = Severity::note;
  variant.truth.exits = {0};
  return true;
}

/// Two families are stated of which one holds the other's codes.
bool nested_families(Variant& variant, Random& random) {
  constexpr const char* kParts[] = {"aruco_4x4_50", "aruco_4x4_100", "aruco_4x4_250"};
  const char* part = kParts[random.below(3)];
  variant.on_markers = [part](std::string& text) {
    // Sizes of single ids are not what this is about.
    if (const auto sizes = text.find("[[markers.sizes]]"); sizes != std::string::npos) {
      text.erase(sizes);
    }
    text += fmt::format("\n[[markers]]\nfamily = \"{}\"\nsize_m = 0.2\n", part);
  };
  refused(variant, Cause::family);
  return true;
}

/// Some ids that hang there are not listed, or none is.
bool unlisted(Variant& variant, Random& random) {
  World& world = variant.world();
  const bool none = random.uniform() < 0.3;
  MarkerCatalog::FamilyEntry entry = world.stated_catalog.entries().front();
  entry.default_size_m.reset();
  entry.size_m_by_id.clear();
  if (none) {
    entry.size_m_by_id[999] = 0.3;
    if (world.stated_catalog.size_m({entry.family, 999}) == std::nullopt) return false;
  } else {
    const auto seen = often_seen(world, 4, 40, random);
    if (seen.size() < 8) return false;
    for (std::size_t i = 2; i < seen.size(); ++i) {
      const auto& marker = world.scene.markers[seen[i]];
      entry.size_m_by_id[marker.id.number] = marker.size_m;
    }
  }
  world.stated_catalog = MarkerCatalog({entry});
  variant.truth.causes = {Cause::unlisted_ids};
  for (const auto& marker : world.scene.markers) variant.truth.markers.insert(marker.id);
  variant.truth.at_least = Severity::note;
  variant.truth.exits = {none ? 65 : 0};
  return true;
}

/// A lens cap.
bool blind(Variant& variant, Random& random) {
  const World& world = variant.world();
  const auto camera = static_cast<int>(random.below(world.cameras()));
  variant.on_images.emplace_back([camera](std::vector<ImageDetections>& images) {
    for (ImageDetections& image : images) {
      if (image.camera == camera) image.detections.clear();
    }
  });
  variant.truth.causes = {Cause::blind_camera};
  variant.truth.cameras = {world.rig.cameras[static_cast<std::size_t>(camera)].name};
  variant.truth.exits = {0};
  return true;
}

constexpr Fault kFaults[] = {
    {Cause::stamps, "s, ms, us, frame numbers, zero", 1, false, stamps},
    {Cause::csv, "another form of detections.csv", 1, false, csv},
    {Cause::format, "a calibration of ROS or OpenCV", 1, false, format},
    {Cause::family, "a family within another", 1, false, nested_families},
    {Cause::unlisted_ids, "ids not listed", 1, false, unlisted},
    {Cause::blind_camera, "a camera that sees nothing", 2, false, blind},
};

}  // namespace

std::span<const Fault> input_faults() { return kFaults; }

}  // namespace waymark::bench
