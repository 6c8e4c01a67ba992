// Whether a recording of emulated cameras holds exactly what they showed: every image equals, pixel
// by pixel but for the cameras' noise, one of the capture that the cameras were given, all images
// of a frame set are of one instant of it, and there are so many images, and sets of all cameras,
// at least. Prints counts; exit code 1 when something differs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>
#include <set>

#include "core/capture/capture_folder.h"
#include "core/capture/image_file.h"
#include "tests/vm/uvc_camera/frame_feed.h"

namespace {

using namespace waymark;

/// Pixels → how many images of that camera come before it. Read once: what is looked up is large.
using Shown = std::vector<std::map<std::vector<std::uint8_t>, int>>;

/// Without the cameras' noise.
std::vector<std::uint8_t> quiet(GrayImage image) {
  const int rows = std::min(static_cast<int>(uvc::kNoiseRows), image.height_px);
  std::for_each(image.pixels.data(), image.row(rows),
                [](std::uint8_t& pixel) { pixel &= static_cast<std::uint8_t>(~uvc::kNoiseBit); });
  return std::move(image.pixels);
}

Expected<Shown> images_shown(const CaptureFolder& capture) {
  Shown shown(capture.rig.cameras.size());
  std::vector<int> count(shown.size(), 0);
  for (const ImageFile& file : capture.images) {
    auto loaded = read_gray_image(file.path);
    if (!loaded) return tl::make_unexpected(loaded.error());
    const auto camera = static_cast<std::size_t>(file.camera);
    shown[camera].emplace(quiet(std::move(loaded->image)), count[camera]++);
  }
  return shown;
}

struct Findings {
  std::size_t images = 0, sets = 0, full_sets = 0;
  std::size_t foreign = 0;  ///< images that no camera showed
  std::size_t mixed = 0;    ///< sets of more than one instant
};

Expected<Findings> compare(const CaptureFolder& recording, const Shown& shown, Stamp tolerance) {
  std::vector<StampedImage> stamped;
  for (const ImageFile& file : recording.images) stamped.push_back({file.camera, file.stamp});
  Findings findings;
  findings.images = stamped.size();
  for (const FrameSet& set : group_into_frame_sets(stamped, tolerance)) {
    std::set<int> instants;
    for (const std::size_t i : set.images) {
      auto loaded = read_gray_image(recording.images[i].path);
      if (!loaded) return tl::make_unexpected(loaded.error());
      const auto& known = shown[static_cast<std::size_t>(recording.images[i].camera)];
      const auto found = known.find(quiet(std::move(loaded->image)));
      if (found == known.end()) {
        ++findings.foreign;
      } else {
        instants.insert(found->second);
      }
    }
    ++findings.sets;
    if (set.images.size() == recording.rig.cameras.size()) ++findings.full_sets;
    if (instants.size() > 1) ++findings.mixed;
  }
  return findings;
}

Expected<Findings> run(const std::string& recorded, const std::string& given) {
  const auto recording = open_capture_folder(recorded);
  if (!recording) return tl::make_unexpected(recording.error());
  const auto capture = open_capture_folder(given);
  if (!capture) return tl::make_unexpected(capture.error());
  const auto shown = images_shown(*capture);
  if (!shown) return tl::make_unexpected(shown.error());
  return compare(*recording, *shown, recording->sync_tolerance);
}

}  // namespace

int main(int argc, char** argv) {
  std::string recording;
  std::string capture;
  std::size_t images = 1;
  std::size_t full = 0;
  CLI::App app{"Whether a recording of emulated cameras holds exactly what they showed"};
  app.add_option("recording", recording)->required();
  app.add_option("capture", capture, "What the cameras were given")->required();
  app.add_option("--images", images, "Images that there must be at least");
  app.add_option("--full", full, "Sets of all cameras that there must be at least");
  CLI11_PARSE(app, argc, argv);
  const auto findings = run(recording, capture);
  if (!findings) {
    fmt::print(stderr, "compare_recording: {}\n", findings.error().message);
    return findings.error().exit_code();
  }
  fmt::print(
      "{} images in {} sets, {} of all cameras; {} images that no camera showed, {} sets of "
      "several instants\n",
      findings->images, findings->sets, findings->full_sets, findings->foreign, findings->mixed);
  const bool enough = findings->images >= images && findings->full_sets >= full;
  return enough && findings->foreign == 0 && findings->mixed == 0 ? 0 : 1;
}
