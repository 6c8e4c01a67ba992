#include "mapbuilder/calibrate/found_rig.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mapbuilder/calibrate/calibrated_cameras.h"
#include "mapbuilder/calibrate/extrinsics_from_instants.h"
#include "mapbuilder/calibrate/lens_growth.h"
#include "mapbuilder/diagnosis/mono_build.h"

namespace waymark {
namespace {

class RigFinder {
 public:
  RigFinder(std::vector<DetectedCapture> captures, const RigCalibrationOptions& options,
            Progress& progress)
      : captures_(std::move(captures)), options_(options), progress_(progress) {
    found_.rig = captures_.front().rig;
    found_.rig.joint_sigmas.reset();  // of the numbers that it had
  }

  Expected<FoundRig> find() {
    if (auto lenses = find_lenses(); !lenses) return tl::make_unexpected(lenses.error());
    find_places();
    return std::move(found_);
  }

 private:
  Status find_lenses() {
    progress_.begin("finding lenses", found_.rig.cameras.size());
    for (std::size_t k = 0; k < found_.rig.cameras.size(); ++k) {
      RigCamera& camera = found_.rig.cameras[k];
      const auto alone = captures_of_camera(captures_, k);
      if (alone.empty()) {
        return fail(Cause::blind_camera,
                    "{}: sees no marker in any of its images: nothing tells its lens; record it "
                    "with markers in view",
                    camera.name);
      }
      const auto grown = grow_lens(alone, options_.lens, options_.build);
      if (!grown) {
        return fail(Cause::few_views,
                    "{}: none of its images shows two markers together, so that no map and no lens "
                    "come of them; hang markers closer to each other",
                    camera.name);
      }
      auto model = CameraModel::create(grown->parameters);
      if (!model) return fail(Cause::few_views, "{}: {}", camera.name, model.error().message);
      camera.model = *std::move(model);
      found_.lenses.push_back(grown->evidence);
      progress_.update(k + 1);
    }
    progress_.end();
    return {};
  }

  /// Where one map of all images tells where every camera stood, how they stand to each other.
  void find_places() {
    if (found_.rig.cameras.size() < 2) return;
    const Rigid3 rig_from_first = found_.rig.cameras.front().rig_from_cam;
    found_.rig.has_extrinsics = false;
    const auto told = with_rig(captures_, found_.rig);
    const auto mono = build_mono(telling_images(told), options_.build);
    if (!mono) return;
    CameraTracks tracks;
    for (const DetectedCapture& capture : told) {
      auto localized = localize_images(capture, *mono, options_.build);
      if (!localized) continue;
      CameraTracks more = tracks_of(*localized, found_.rig, capture.sync_tolerance);
      tracks.cameras = std::move(more.cameras);
      for (auto& instant : more.instants) tracks.instants.push_back(std::move(instant));
    }
    const auto places = extrinsics_from_instants(tracks);
    std::vector<std::string> loose;
    for (std::size_t k = 0; k < places.size(); ++k) {
      if (places[k]) {
        found_.rig.cameras[k].rig_from_cam = rig_from_first * *places[k];
      } else {
        loose.push_back(found_.rig.cameras[k].name);
      }
    }
    if (places.empty() || !loose.empty()) return say_that_places_are_unknown(loose);
    found_.rig.has_extrinsics = true;
  }

  void say_that_places_are_unknown(const std::vector<std::string>& loose) {
    for (RigCamera& camera : found_.rig.cameras) camera.rig_from_cam = Rigid3{};
    Finding finding;
    finding.cause = Cause::few_views;
    finding.subject = loose.empty() ? "rig" : fmt::format("{}", fmt::join(loose, ", "));
    finding.cameras = loose;
    finding.text = fmt::format(
        "where it stands against {} is not told: no three instants at which both are localized in "
        "one map. The lenses are calibrated, the rig file has no transforms and is good for --mono "
        "alone.",
        found_.rig.cameras.front().name);
    finding.remedy =
        "Record all cameras at once, by one clock, on a way that leads each past markers that "
        "others see as well, now or later.";
    found_.findings.push_back(std::move(finding));
  }

  std::vector<DetectedCapture> captures_;
  const RigCalibrationOptions& options_;
  Progress& progress_;
  FoundRig found_;
};

}  // namespace

Expected<FoundRig> find_rig(std::vector<DetectedCapture> captures,
                            const RigCalibrationOptions& options, Progress& progress) {
  if (captures.empty()) return fail(ErrorKind::usage, "no capture given: name at least one");
  auto of_one_rig = with_common_rig(std::move(captures));
  if (!of_one_rig) return tl::make_unexpected(of_one_rig.error());
  return RigFinder(*std::move(of_one_rig), options, progress).find();
}

}  // namespace waymark
