#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/atomic_file.h"
#include "core/capture/capture_folder.h"
#include "core/capture/detections_csv.h"
#include "core/geometry/tum.h"
#include "simulator/covisibility.h"
#include "simulator/scene_library.h"
#include "simulator/simulate_detections.h"
#include "tests/support/full_disk.h"
#include "tests/support/temporary_folder.h"

namespace waymark::simulator {
namespace {

namespace fs = std::filesystem;

class Detections : public testing::Test {
 protected:
  /// Simulates into a folder of the test's own; fails the test when that fails.
  fs::path simulate(const std::string& folder, const DetectionsJob& job) {
    const auto result = simulate_detections(*scene_, *rig_, job, out(folder), stop_);
    EXPECT_TRUE(result.has_value()) << result.error().message;
    return out(folder);
  }
  [[nodiscard]] fs::path out(const std::string& folder) const { return temporary_.path() / folder; }

  static DetectionsJob quiet() {
    DetectionsJob job;
    job.show_progress = false;
    job.threads = 2;
    return job;
  }
  static std::vector<ImageDetections> read(const fs::path& folder) {
    const auto capture = open_capture_folder(folder);
    EXPECT_TRUE(capture.has_value()) << capture.error().message;
    auto table = read_detections_csv(*capture->detections_csv, capture->rig, capture->catalog);
    EXPECT_TRUE(table.has_value()) << table.error().message;
    return table->images;
  }
  static nlohmann::json corruptions(const fs::path& folder) {
    return nlohmann::json::parse(*read_file(folder / "groundtruth" / "corruptions.json"));
  }

  TemporaryFolder temporary_;
  std::atomic<bool> stop_{false};
  Expected<Scene> scene_ = load_scene("room1");
  Expected<SimulatedRig> rig_ = load_rig("cg120");
};

std::size_t count(const std::vector<ImageDetections>& images) {
  std::size_t sum = 0;
  for (const ImageDetections& image : images) sum += image.detections.size();
  return sum;
}

TEST_F(Detections, NoiseIsGaussianOfTheStatedSigmaAndSaysSo) {
  DetectionsJob job = quiet();
  job.noise_px = 0;
  const auto truth = read(simulate("truth", job));
  job.noise_px = 0.1;
  const auto noisy = read(simulate("noisy", job));
  ASSERT_EQ(truth.size(), noisy.size());
  double sum = 0;
  double squares = 0;
  int beyond_two_sigma = 0;
  int n = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    ASSERT_EQ(truth[i].detections.size(), noisy[i].detections.size());
    for (std::size_t k = 0; k < truth[i].detections.size(); ++k) {
      EXPECT_FALSE(truth[i].detections[k].covariances.has_value());
      ASSERT_TRUE(noisy[i].detections[k].covariances.has_value());
      for (std::size_t c = 0; c < 4; ++c) {
        EXPECT_NEAR((*noisy[i].detections[k].covariances)[c](0, 0), 0.01, 1e-9);
        EXPECT_EQ((*noisy[i].detections[k].covariances)[c](0, 1), 0.0);
        const Eigen::Vector2d error =
            noisy[i].detections[k].corners[c] - truth[i].detections[k].corners[c];
        for (const double e : {error.x(), error.y()}) {
          sum += e;
          squares += e * e;
          beyond_two_sigma += std::abs(e) > 0.2 ? 1 : 0;
          ++n;
        }
      }
    }
  }
  ASSERT_GT(n, 5000);
  EXPECT_NEAR(sum / n, 0.0, 4 * 0.1 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.1, 0.003);
  EXPECT_NEAR(static_cast<double>(beyond_two_sigma) / n, 0.0455, 0.01);
}

TEST_F(Detections, DependOnTheSeedAndNotOnThreads) {
  DetectionsJob job = quiet();
  job.false_rate = 0.05;
  job.miss_rate = 0.05;
  job.threads = 1;
  const auto one = read_file(simulate("one", job) / "detections.csv");
  job.threads = 7;
  const auto seven = read_file(simulate("seven", job) / "detections.csv");
  job.seed = 2;
  const auto other = read_file(simulate("other", job) / "detections.csv");
  EXPECT_EQ(*one, *seven);
  EXPECT_NE(*one, *other);
}

TEST_F(Detections, MissesDropOutsAndFalseIdsComeAtTheirRates) {
  DetectionsJob job = quiet();
  const auto all = read(simulate("all", job));
  job.miss_rate = 0.2;
  EXPECT_NEAR(static_cast<double>(count(read(simulate("missed", job)))), 0.8 * count(all),
              0.05 * count(all));
  job.miss_rate = 0;
  job.drop_out_rate = 0.1;
  const fs::path dropped = simulate("dropped", job);
  const auto kept = read(dropped);
  EXPECT_LT(kept.size(), all.size());
  EXPECT_EQ(kept.size() + corruptions(dropped)["dropped_images"].size(), all.size());
  job.drop_out_rate = 0;
  job.false_rate = 0.1;
  const fs::path misread = simulate("misread", job);
  const auto false_ids = corruptions(misread)["false_ids"];
  EXPECT_NEAR(static_cast<double>(false_ids.size()), 0.1 * count(all), 0.04 * count(all));
  for (const auto& entry : false_ids) EXPECT_NE(entry["id"], entry["read_as"]);
}

TEST_F(Detections, CorruptedMarkersAreNamedAndAmbiguousOnesHaveNoTruth) {
  DetectionsJob job = quiet();
  job.twins = 3;
  job.moved = 3;
  job.mis_sized = 2;
  const fs::path folder = simulate("corrupted", job);
  const auto named = corruptions(folder);
  std::set<std::string> ambiguous;
  std::set<std::string> all;
  for (const char* kind : {"twins", "moved", "mis_sized"}) {
    for (const auto& entry : named[kind]) {
      all.insert(entry["id"]);
      if (kind != std::string("mis_sized")) ambiguous.insert(entry["id"]);
    }
  }
  EXPECT_EQ(all.size(), 8U) << "each marker is corrupted in one way only";
  const auto truth = read_tum(folder / "groundtruth" / "markers.tum");
  ASSERT_TRUE(truth.has_value());
  EXPECT_EQ(truth->size(), scene_->markers.size() - ambiguous.size());
  for (const TumPose& pose : *truth) EXPECT_FALSE(ambiguous.contains(pose.key));
  for (const auto& twin : named["twins"]) {
    const auto at = [](const nlohmann::json& pose) {
      return Eigen::Vector3d(pose["position_m"][0], pose["position_m"][1], pose["position_m"][2]);
    };
    EXPECT_GE((at(twin["world_from_marker"]) - at(twin["world_from_second"])).norm(), 2.0);
  }
  // Two prints can't hang at one place, whenever.
  std::vector<Eigen::Vector3d> new_places;
  const auto place = [](const nlohmann::json& pose) {
    return Eigen::Vector3d(pose["position_m"][0], pose["position_m"][1], pose["position_m"][2]);
  };
  for (const auto& twin : named["twins"]) new_places.push_back(place(twin["world_from_second"]));
  for (const auto& moved : named["moved"]) new_places.push_back(place(moved["after"]));
  for (std::size_t i = 0; i < new_places.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) EXPECT_GT((new_places[i] - new_places[j]).norm(), 0.2);
  }
  // A twin is seen twice in one image or in places that one marker can't be seen from.
  EXPECT_GT(count(read(folder)), count(read(simulate("clean", quiet()))));
}

TEST_F(Detections, ExistingOutputIsRefusedAndUntouched) {
  const fs::path folder = simulate("mine", quiet());
  const auto before = read_file(folder / "detections.csv");
  const auto again = simulate_detections(*scene_, *rig_, quiet(), folder, stop_);
  ASSERT_FALSE(again.has_value());
  EXPECT_EQ(again.error().kind, ErrorKind::cant_create);
  EXPECT_EQ(*before, *read_file(folder / "detections.csv"));
  const auto nowhere = simulate_detections(*scene_, *rig_, quiet(), out("no/such/place"), stop_);
  ASSERT_FALSE(nowhere.has_value());
  EXPECT_EQ(nowhere.error().kind, ErrorKind::cant_create);
}

TEST_F(Detections, InterruptionLeavesNothingBehind) {
  stop_ = true;
  const auto result = simulate_detections(*scene_, *rig_, quiet(), out("stopped"), stop_);
  ASSERT_FALSE(result.has_value());
  EXPECT_TRUE(fs::is_empty(temporary_.path()));
}

TEST_F(Detections, AFullDiskLeavesNothingBehind) {
  Expected<DetectionsResult> result = tl::make_unexpected(Error{ErrorKind::internal, ""});
  {
    const test::FullDisk full(20'000);  // enough for the description, not for the detections
    result = simulate_detections(*scene_, *rig_, quiet(), out("full"), stop_);
  }
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().kind, ErrorKind::io) << result.error().message;
  EXPECT_TRUE(fs::is_empty(temporary_.path()));
}

TEST_F(Detections, MoreCorruptedMarkersThanThereAreIsAUsageError) {
  DetectionsJob job = quiet();
  job.twins = 61;
  const auto result = simulate_detections(*scene_, *rig_, job, out("many"), stop_);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().kind, ErrorKind::usage);
  EXPECT_TRUE(fs::is_empty(temporary_.path()));
}

TEST_F(Detections, WarehousesByFormulaAreOneGraph) {
  const auto scene = load_scene("aisles2");
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  EXPECT_EQ(scene->markers.size(), 400U);
  EXPECT_EQ(scene->trajectory.positions, 2000);
  const DetectionGraph graph = detection_graph(*scene, *rig_);
  EXPECT_EQ(graph.components, 1);
  EXPECT_EQ(graph.unseen_markers, 0);
  EXPECT_NEAR(graph.observations / 2000.0, 18, 4) << "per frame set";
}

}  // namespace
}  // namespace waymark::simulator
