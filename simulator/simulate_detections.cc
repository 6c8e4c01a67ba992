#include "simulator/simulate_detections.h"

#include <algorithm>
#include <fstream>
#include <set>

#include "core/base/atomic_file.h"
#include "core/base/growing_folder.h"
#include "core/base/parallel.h"
#include "core/base/progress.h"
#include "core/capture/detections_csv_text.h"
#include "simulator/capture_output.h"
#include "simulator/capture_plan.h"
#include "simulator/corruption.h"
#include "simulator/random.h"
#include "simulator/visibility.h"

namespace waymark::simulator {
namespace {

/// Images that are simulated at once before their rows are written.
constexpr std::size_t kImagesAtOnce = 3000;

/// What became of one exposure.
struct SimulatedImage {
  bool dropped = false;
  ImageDetections found;
  std::vector<FalseId> false_ids;
};

/// Looks at the building through one exposure, with all that can go wrong.
class DetectionSimulator {
 public:
  DetectionSimulator(const Scene& scene, const SimulatedRig& rig, const CapturePlan& plan,
                     const Corruption& corruption, const DetectionsJob& job)
      : scene_(scene),
        rig_(rig),
        plan_(plan),
        job_(job),
        before_(corruption.scene_before(scene)),
        after_(corruption.scene_after(scene)),
        visible_before_(before_),
        visible_after_(after_),
        moved_from_(corruption.moves.empty() ? plan.exposures().size()
                                             : corruption.moves.front().from_position) {}

  [[nodiscard]] SimulatedImage look(const Exposure& exposure) const {
    Random random = Random::of({job_.seed, 8, exposure.camera, exposure.position});
    SimulatedImage image;
    image.dropped = random.uniform() < job_.drop_out_rate;
    image.found.stamp = exposure.stamp;
    image.found.camera = static_cast<int>(exposure.camera);
    if (image.dropped) return image;
    const bool after_moves = exposure.position >= moved_from_;
    const Scene& building = after_moves ? after_ : before_;
    const Visibility& visibility = after_moves ? visible_after_ : visible_before_;
    for (const VisibleMarker& seen : visibility.visible_from(
             rig_.rig.cameras[exposure.camera].model, plan_.world_from_cam(exposure))) {
      if (random.uniform() < job_.miss_rate) continue;
      const MarkerId truth = building.markers[seen.marker].id;
      Detection detection = noisy(truth, seen.corners, random);
      if (random.uniform() < job_.false_rate) {
        detection.marker = misread(truth, random);
        image.false_ids.push_back({exposure, truth, detection.marker});
      }
      image.found.detections.push_back(detection);
    }
    return image;
  }

 private:
  [[nodiscard]] Detection noisy(const MarkerId& id, const ImageCorners& corners,
                                Random& random) const {
    Detection detection{
        .marker = id, .corners = corners, .covariances = std::nullopt, .hamming = 0};
    if (job_.noise_px <= 0) return detection;
    for (Eigen::Vector2d& corner : detection.corners) {
      corner += job_.noise_px * Eigen::Vector2d(random.normal(), random.normal());
    }
    detection.covariances.emplace();
    detection.covariances->fill(job_.noise_px * job_.noise_px * Eigen::Matrix2d::Identity());
    return detection;
  }

  /// Another id: half of them hang elsewhere in the building, half do not exist there.
  [[nodiscard]] MarkerId misread(const MarkerId& truth, Random& random) const {
    const bool existing = random.uniform() < 0.5;
    for (;;) {
      MarkerId read = scene_.markers[random.below(scene_.markers.size())].id;
      if (!existing) {
        read.number = static_cast<int>(
            random.below(static_cast<std::uint64_t>(traits(read.family).id_count)));
      }
      if (read != truth && scene_.catalog.size_m(read)) return read;
      if (scene_.markers.size() == 1 && existing) return truth;
    }
  }

  const Scene& scene_;
  const SimulatedRig& rig_;
  const CapturePlan& plan_;
  const DetectionsJob& job_;
  Scene before_, after_;
  Visibility visible_before_, visible_after_;
  std::size_t moved_from_;
};

/// The truth of the map: markers that hang in one place only.
Scene without_ambiguous(const Scene& scene, const Corruption& corruption) {
  std::set<std::size_t> ambiguous;
  for (const auto& twin : corruption.twins) ambiguous.insert(twin.marker);
  for (const auto& move : corruption.moves) ambiguous.insert(move.marker);
  Scene rest = scene;
  rest.markers.clear();
  for (std::size_t i = 0; i < scene.markers.size(); ++i) {
    if (!ambiguous.contains(i)) rest.markers.push_back(scene.markers[i]);
  }
  return rest;
}

}  // namespace

Expected<DetectionsResult> simulate_detections(const Scene& scene, const SimulatedRig& rig,
                                               const DetectionsJob& job,
                                               const std::filesystem::path& folder,
                                               const std::atomic<bool>& stop) {
  auto output = GrowingFolder::begin(folder);
  if (!output) return tl::make_unexpected(output.error());
  const int positions = job.positions > 0 ? job.positions : scene.trajectory.positions;
  const CapturePlan plan(scene, rig, positions, job.stamp_skew_sigma_s > 0, job.stamp_skew_sigma_s,
                         job.seed);
  const auto corruption = draw_corruption(scene, rig, plan, job);
  if (!corruption) return tl::make_unexpected(corruption.error());
  const std::string session =
      fmt::format("{} {} detections {} px seed {}", scene.name, rig.name, job.noise_px, job.seed);
  if (auto status = write_description(output->path(), without_ambiguous(scene, *corruption), rig,
                                      plan, 0.0, session);
      !status) {
    return tl::make_unexpected(status.error());
  }

  const DetectionSimulator simulator(scene, rig, plan, *corruption, job);
  const bool with_covariances = job.noise_px > 0;
  const auto csv_path = output->path() / "detections.csv";
  std::ofstream csv(csv_path, std::ios::binary);
  csv << detections_csv_head(scene.catalog, "simulator", with_covariances);
  Progress progress(job.show_progress);
  progress.begin("detections", plan.exposures().size());
  DetectionsResult result;
  std::vector<FalseId> false_ids;
  std::vector<Exposure> dropped;
  const auto& exposures = plan.exposures();
  for (std::size_t begin = 0; begin < exposures.size() && csv && !stop; begin += kImagesAtOnce) {
    std::vector<SimulatedImage> images(std::min(kImagesAtOnce, exposures.size() - begin));
    parallel_for(images.size(), effective_threads(job.threads),
                 [&](std::size_t i) { images[i] = simulator.look(exposures[begin + i]); });
    std::vector<ImageDetections> kept;
    for (std::size_t i = 0; i < images.size(); ++i) {
      SimulatedImage& image = images[i];
      if (image.dropped) {
        dropped.push_back(exposures[begin + i]);
        continue;
      }
      result.detections += image.found.detections.size();
      false_ids.insert(false_ids.end(), image.false_ids.begin(), image.false_ids.end());
      kept.push_back(std::move(image.found));
    }
    result.images += kept.size();
    std::string rows;
    append_detections_csv_rows(kept, rig.rig, scene.catalog.several_families(), with_covariances,
                               rows);
    csv << rows;
    progress.update(begin + images.size());
  }
  progress.end();
  csv.close();
  if (!csv) return fail(ErrorKind::io, "{}: writing failed; is the disk full?", csv_path.string());
  if (stop) return fail(ErrorKind::io, "{}: interrupted; nothing was written", folder.string());
  Status status =
      write_file_atomically(output->path() / "groundtruth" / "corruptions.json",
                            format_corruptions(scene, rig, plan, *corruption, false_ids, dropped));
  if (status) status = output->finish();
  if (!status) return tl::make_unexpected(status.error());
  return result;
}

}  // namespace waymark::simulator
