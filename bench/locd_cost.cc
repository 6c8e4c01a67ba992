// What a frame set costs. Usage: bench_locd_cost CAPTURE MAP [SETS [--detections|--record DIR]];
// plays the capture in a loop, as fast as it goes. --detections plays its detections.csv, which
// leaves the detector out; --record plays 10 sets a second and records every other 25 of them in
// DIR, as PGM. Times are per set, from frames to pose, without decoding and publishing.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bench/allocation_count.h"
#include "core/map/map_file.h"
#include "drivers/monotonic_clock.h"
#include "drivers/replay_source.h"
#include "locd/pose/localizer.h"
#include "locd/publish/telemetry.h"
#include "locd/record/recorder.h"

namespace waymark::bench {
namespace {

double milliseconds(Stamp duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

void print_times(const char* stage, std::vector<Stamp> times) {
  std::sort(times.begin(), times.end());
  const auto quantile = [&](double q) {
    return milliseconds(times[static_cast<std::size_t>(q * static_cast<double>(times.size() - 1))]);
  };
  fmt::print("  {:<22} p50 {:7.3f} ms  p99 {:7.3f} ms  max {:7.3f} ms\n", stage, quantile(0.5),
             quantile(0.99), quantile(1.0));
}

/// What this thread computed, whatever else the machine did meanwhile.
Stamp thread_time() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + Stamp(time.tv_nsec);
}

double resident_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) return std::stod(line.substr(6)) / 1024;
  }
  return 0;
}

/// A capture played set by set.
class Player {
 public:
  static std::optional<Player> open(const std::string& folder, bool detections) {
    ReplayOptions options;
    options.loop = true;
    options.images = !detections;
    options.detections = detections;
    auto capture = ReplayCapture::open(folder, options);
    if (!capture) {
      fmt::print(stderr, "{}\n", capture.error().message);
      return std::nullopt;
    }
    return Player(*capture);
  }

  [[nodiscard]] const Rig& rig() const { return capture_->folder().rig; }

  [[nodiscard]] std::optional<FrameSetLease> next() {
    for (;;) {
      for (std::size_t c = 0; c < sources_.size(); ++c) {
        auto frame = sources_[c]->next(Stamp::max());
        if (!frame || !*frame) return std::nullopt;
        const Stamp stamp = (*frame)->stamp();
        synchronizer_.push(c, std::move(**frame), stamp);
      }
      if (auto set = synchronizer_.take(Stamp::max())) return set;
    }
  }

 private:
  explicit Player(std::shared_ptr<ReplayCapture> capture)
      : capture_(std::move(capture)),
        sources_(ReplayCapture::sources(capture_)),
        synchronizer_(sources_.size(), sync_options(*capture_)) {}

  static SyncOptions sync_options(const ReplayCapture& capture) {
    SyncOptions options;
    options.tolerance = capture.folder().sync_tolerance;
    return options;
  }

  std::shared_ptr<ReplayCapture> capture_;
  std::vector<std::unique_ptr<FrameSource>> sources_;
  FrameSynchronizer synchronizer_;
};

constexpr int kWarmUp = 20;

int measure_stages(Player& player, const MarkerMap& map, int sets, bool detections, Stamp started) {
  Localizer localizer(player.rig(), map, {});
  LcmOptions lcm;
  lcm.url = "memq://";
  SessionFacts session;
  session.session_id = new_session_id();
  session.cameras = player.rig().cameras.size();
  Telemetry telemetry(lcm, session, read_clocks());
  tell_libraries_apart();
  PoseEstimate estimate;
  std::vector<Stamp> detect, solve, watch, rest, computed;
  for (auto* times : {&detect, &solve, &watch, &rest, &computed})
    times->reserve(static_cast<std::size_t>(sets));
  AllocationCount spent;
  int ok = 0;
  for (int i = 0; i < sets + kWarmUp; ++i) {
    const auto set = player.next();
    if (!set) return 65;
    const AllocationCount before = allocations();
    const Stamp computed_before = thread_time();
    const Stamp begun = monotonic_now();
    localizer.localize(*set, estimate);
    const Stamp all = monotonic_now() - begun;
    telemetry.publish_pose(estimate, monotonic_now());
    const AllocationCount after = allocations();
    if (i == 0) {
      fmt::print("  start to first pose: {:.0f} ms\n", milliseconds(monotonic_now() - started));
    }
    if (i < kWarmUp) continue;
    ok += estimate.status == PoseStatus::ok ? 1 : 0;
    for (auto part : {&AllocationCount::ours, &AllocationCount::opencv, &AllocationCount::lcm,
                      &AllocationCount::others}) {
      spent.*part += after.*part - before.*part;
    }
    detect.push_back(estimate.times.detect);
    solve.push_back(estimate.times.solve);
    watch.push_back(estimate.times.watch);
    rest.push_back(all - estimate.times.detect);
    computed.push_back(thread_time() - computed_before);
  }
  fmt::print("  {} sets, {} OK\n", detect.size(), ok);
  print_times("detection", detect);
  print_times("solve", solve);
  print_times("of that, watches", watch);
  print_times("all but detection", rest);
  if (detections) print_times("the same, CPU time", computed);
  const auto count = static_cast<double>(std::max<std::size_t>(1, detect.size()));
  fmt::print(
      "  allocations per set, published: ours {:.2f}, OpenCV's {:.2f}, LCM's {:.2f}, others' "
      "{:.2f}\n",
      static_cast<double>(spent.ours) / count, static_cast<double>(spent.opencv) / count,
      static_cast<double>(spent.lcm) / count, static_cast<double>(spent.others) / count);
  fmt::print("  resident: {:.1f} MB\n", resident_mb());
  return 0;
}

constexpr Stamp kDiskPatience = std::chrono::seconds(30);

/// Ends the recording, if there is one: how many sets it has on the disk.
std::uint64_t end_of(Recorder& recorder) {
  if (recorder.state().phase == Recorder::Phase::idle) return 0;
  recorder.stop();
  return recorder.settle(monotonic_now() + kDiskPatience) ? recorder.state().sets : 0;
}

/// The same sets by turns with and without a recording, so that whatever else the machine does
/// meets both.
int measure_recording(Player& player, const MarkerMap& map, int sets, const std::string& folder) {
  constexpr int kBlock = 25;
  constexpr Stamp kPeriod = std::chrono::milliseconds(100);
  Localizer localizer(player.rig(), map, {});
  RecorderOptions options;
  RecordingFacts facts;
  facts.codec = "pgm";
  for (const RigCamera& camera : player.rig().cameras) {
    const CameraParameters& size = camera.model.parameters();
    options.pixels.push_back(static_cast<std::size_t>(size.width_px) *
                             static_cast<std::size_t>(size.height_px));
    facts.cameras.push_back(camera.name);
  }
  options.budget.min_free_bytes = 0;
  Recorder recorder;
  PoseEstimate estimate;
  std::array<std::vector<Stamp>, 2> times;
  std::uint64_t recorded = 0;
  Stamp due = monotonic_now();
  for (int i = -kWarmUp; i < sets; ++i) {
    const bool records = i >= 0 && i / kBlock % 2 == 1;
    if (i >= 0 && i % kBlock == 0) {
      recorded += end_of(recorder);
      if (records) recorder.start(fmt::format("{}/{}", folder, i), facts, options);
      if (!recorder.settle(monotonic_now() + kDiskPatience) || recorder.state().failure) {
        fmt::print(stderr, "{}/{}: can't record here\n", folder, i);
        return 74;
      }
    }
    auto set = player.next();
    if (!set) return 65;
    due = std::max(due + kPeriod, monotonic_now());
    std::this_thread::sleep_for(due - monotonic_now());
    const Stamp begun = monotonic_now();
    localizer.localize(*set, estimate);
    const Stamp done = monotonic_now();
    if (records) recorder.offer(*set, Stamp{0});
    if (i >= 0) times[records ? 1 : 0].push_back(done - begun);
  }
  recorded += end_of(recorder);
  print_times("set to pose", times[0]);
  print_times("the same, recording", times[1]);
  fmt::print("  {} sets recorded, {} not for want of memory\n", recorded, recorder.state().drops);
  return 0;
}

}  // namespace
}  // namespace waymark::bench

int main(int argc, char** argv) {
  using namespace waymark::bench;
  const std::string mode = argc > 4 ? argv[4] : "";
  if (argc < 3 || (mode == "--record" && argc != 6) ||
      (mode != "" && mode != "--record" && mode != "--detections")) {
    fmt::print(stderr, "usage: bench_locd_cost CAPTURE MAP [SETS [--detections|--record DIR]]\n");
    return 64;
  }
  const waymark::Stamp started = waymark::monotonic_now();
  const auto map = waymark::read_map_file(argv[2]);
  if (!map) {
    fmt::print(stderr, "{}\n", map.error().message);
    return 65;
  }
  auto player = Player::open(argv[1], mode == "--detections");
  if (!player) return 65;
  const int sets = argc > 3 ? std::atoi(argv[3]) : 300;
  if (mode == "--record") return measure_recording(*player, *map, sets, argv[5]);
  return measure_stages(*player, *map, sets, mode == "--detections", started);
}
