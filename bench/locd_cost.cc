// What a frame set costs. Usage: bench_locd_cost CAPTURE MAP [SETS [--detections]]; plays the
// capture in a loop, as fast as it goes; --detections plays its detections.csv, which leaves the
// detector out. Times are per set, from frames to pose, without decoding and publishing.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "bench/allocation_count.h"
#include "core/map/map_file.h"
#include "drivers/monotonic_clock.h"
#include "drivers/replay_source.h"
#include "locd/localizer.h"

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

int run(const std::string& folder, const std::string& map_path, int sets, bool detections) {
  constexpr int kWarmUp = 20;
  const Stamp started = monotonic_now();
  const auto map = read_map_file(map_path);
  ReplayOptions options;
  options.loop = true;
  options.images = !detections;
  options.detections = detections;
  auto capture = ReplayCapture::open(folder, options);
  if (!map || !capture) {
    fmt::print(stderr, "{}\n", map ? capture.error().message : map.error().message);
    return 65;
  }
  auto sources = ReplayCapture::sources(*capture);
  SyncOptions sync_options;
  sync_options.tolerance = (*capture)->folder().sync_tolerance;
  FrameSynchronizer synchronizer(sources.size(), sync_options);
  Localizer localizer((*capture)->folder().rig, *map, {});
  PoseEstimate estimate;
  std::vector<Stamp> detect, solve, watch, rest, computed;
  for (auto* times : {&detect, &solve, &watch, &rest, &computed})
    times->reserve(static_cast<std::size_t>(sets));
  AllocationCount spent;
  int ok = 0;
  for (int i = 0; i < sets + kWarmUp; ++i) {
    for (std::size_t c = 0; c < sources.size(); ++c) {
      auto frame = sources[c]->next(Stamp::max());
      if (!frame || !*frame) return 65;
      const Stamp stamp = (*frame)->stamp();
      synchronizer.push(c, std::move(**frame), stamp);
    }
    auto set = synchronizer.take(Stamp::max());
    if (!set) continue;
    const AllocationCount before = allocations();
    const Stamp computed_before = thread_time();
    const Stamp begun = monotonic_now();
    localizer.localize(*set, estimate);
    const Stamp all = monotonic_now() - begun;
    const AllocationCount after = allocations();
    if (i == 0) {
      fmt::print("  start to first pose: {:.0f} ms\n", milliseconds(monotonic_now() - started));
    }
    if (i < kWarmUp) continue;
    ok += estimate.status == PoseStatus::ok ? 1 : 0;
    spent.ours += after.ours - before.ours;
    spent.libraries += after.libraries - before.libraries;
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
  fmt::print("  allocations per set: ours {:.2f}, libraries' {:.2f}\n",
             static_cast<double>(spent.ours) / count, static_cast<double>(spent.libraries) / count);
  fmt::print("  resident: {:.1f} MB\n", resident_mb());
  return 0;
}

}  // namespace
}  // namespace waymark::bench

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: bench_locd_cost CAPTURE MAP [SETS [--detections]]\n");
    return 64;
  }
  const int sets = argc > 3 ? std::atoi(argv[3]) : 300;
  return waymark::bench::run(argv[1], argv[2], sets, argc > 4);
}
