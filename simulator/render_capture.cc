#include "simulator/render_capture.h"

#include <chrono>
#include <mutex>
#include <optional>

#include "core/base/growing_folder.h"
#include "core/base/parallel.h"
#include "core/base/progress.h"
#include "core/capture/image_file.h"
#include "simulator/capture_output.h"
#include "simulator/capture_plan.h"
#include "simulator/random.h"
#include "simulator/renderer.h"

namespace waymark::simulator {

Expected<RenderResult> render_capture(const Scene& scene, const SimulatedRig& rig,
                                      const RenderJob& job, const std::filesystem::path& folder,
                                      const std::atomic<bool>& stop) {
  const RenderSettings& settings = job.settings;
  auto output = GrowingFolder::begin(folder);
  if (!output) return tl::make_unexpected(output.error());
  const int positions = job.positions > 0 ? job.positions : scene.trajectory.positions;
  const bool moving = settings.exposure_s > 0 || settings.readout_s > 0;
  const CapturePlan plan(scene, rig, positions, moving, settings.stamp_skew_sigma_s, job.seed);
  const std::string session =
      fmt::format("{} {} {} seed {}", scene.name, rig.name, moving ? "drive" : "still", job.seed);
  Status status = write_description(output->path(), scene, rig, plan, settings.exposure_s, session);
  for (const RigCamera& camera : rig.rig.cameras) {
    if (status) status = create_folder(output->path() / camera.name);
  }
  if (!status) return tl::make_unexpected(status.error());

  const int threads = effective_threads(job.threads);
  const Renderer renderer(scene, rig.rig, settings, threads);
  const auto started = std::chrono::steady_clock::now();
  Progress progress(job.show_progress);
  progress.begin("rendering", plan.exposures().size());
  std::mutex mutex;
  std::optional<Error> first_error;
  std::size_t done = 0;
  std::atomic<bool> failed{false};
  parallel_for(plan.exposures().size(), threads, [&](std::size_t i) {
    if (failed || stop) return;
    const Exposure& exposure = plan.exposures()[i];
    const std::uint64_t noise_seed =
        Random::of({job.seed, 6, exposure.camera, exposure.position}).bits();
    const GrayImage image = renderer.render(exposure.camera, plan.motion(exposure), noise_seed);
    const auto path = output->path() / rig.rig.cameras[exposure.camera].name /
                      fmt::format("{}.{}", exposure.stamp.count(), settings.png ? "png" : "jpg");
    const Status written = write_gray_image(path, image.view(), settings.jpeg_quality);
    const std::lock_guard lock(mutex);
    if (!written && !first_error) {
      first_error = written.error();
      failed = true;
    }
    progress.update(++done);
  });
  progress.end();
  if (first_error) return tl::make_unexpected(*first_error);
  if (stop) return fail(ErrorKind::io, "{}: interrupted; nothing was written", folder.string());
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - started;
  if (status = output->finish(); !status) return tl::make_unexpected(status.error());
  return RenderResult{plan.exposures().size(), elapsed.count()};
}

}  // namespace waymark::simulator
