#include "simulator/corruption.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "simulator/random.h"

namespace waymark::simulator {
namespace {

/// A marker seen more seldom tells a mapper nothing about itself.
constexpr int kLeastSightings = 4;
constexpr double kLeastTwinDistance_m = 2.0;
constexpr double kLeastMove_m = 0.15;
constexpr double kMostMove_m = 0.60;
constexpr int kTries = 2000;

/// How often each marker is seen before and after the middle of the way.
struct Sightings {
  std::vector<int> before, after;
};

Sightings count_sightings(const Scene& scene, const SimulatedRig& rig, const CapturePlan& plan) {
  const Visibility visibility(scene);
  Sightings sightings{std::vector<int>(scene.markers.size(), 0),
                      std::vector<int>(scene.markers.size(), 0)};
  const std::size_t middle = plan.exposures().back().position / 2;
  for (const Exposure& exposure : plan.exposures()) {
    auto& counts = exposure.position < middle ? sightings.before : sightings.after;
    for (const VisibleMarker& seen : visibility.visible_from(rig.rig.cameras[exposure.camera].model,
                                                             plan.world_from_cam(exposure))) {
      ++counts[seen.marker];
    }
  }
  return sightings;
}

/// Free place on a surface: the plate fits and no other plate is closer than 1.5 sides.
bool is_free(const Scene& scene, int surface, const Eigen::Vector3d& at, double size_m,
             std::size_t except) {
  const Surface& face = scene.surfaces[static_cast<std::size_t>(surface)];
  const Eigen::Vector3d on_face = at - face.origin;
  const double across = on_face.dot(face.right);
  const double above = on_face.dot(face.up);
  if (across < size_m || above < size_m || across > face.width_m - size_m ||
      above > face.height_m - size_m) {
    return false;
  }
  for (std::size_t i = 0; i < scene.markers.size(); ++i) {
    const PlacedMarker& other = scene.markers[i];
    if (i != except && other.surface == surface &&
        (other.world_from_marker.translation - at).norm() < 0.75 * (size_m + other.size_m) * 1.2) {
      return false;
    }
  }
  return true;
}

/// A place within reach of another marker's, so that the rig comes by.
std::optional<PlacedMarker> place_near(const Scene& scene, std::size_t host,
                                       const PlacedMarker& what, double most_m, std::size_t except,
                                       Random& random) {
  const PlacedMarker& near = scene.markers[host];
  const Surface& face = scene.surfaces[static_cast<std::size_t>(near.surface)];
  const Eigen::Vector3d shift =
      random.uniform(-most_m, most_m) * face.right + random.uniform(-most_m, most_m) * face.up;
  PlacedMarker placed = what;
  placed.surface = near.surface;
  placed.world_from_marker = {near.world_from_marker.rotation,
                              near.world_from_marker.translation + shift};
  if (shift.norm() < kLeastMove_m || shift.norm() > most_m ||
      !is_free(scene, near.surface, placed.world_from_marker.translation, what.size_m, except)) {
    return std::nullopt;
  }
  return placed;
}

/// Draws markers, each once.
class Lottery {
 public:
  Lottery(std::size_t count, Random& random) : taken_(count, false), random_(random) {}

  template <typename Accept>
  std::optional<std::size_t> draw(const Accept& accept) {
    for (int i = 0; i < kTries; ++i) {
      const auto marker = static_cast<std::size_t>(random_.below(taken_.size()));
      if (taken_[marker] || !accept(marker)) continue;
      taken_[marker] = true;
      return marker;
    }
    return std::nullopt;
  }

 private:
  std::vector<bool> taken_;
  Random& random_;
};

tl::unexpected<Error> too_many(const Scene& scene, const char* option) {
  return fail(ErrorKind::usage,
              "scene {}: too few markers are seen often enough for that many {}; ask for fewer",
              scene.name, option);
}

nlohmann::json pose_json(const Rigid3& pose) {
  const Eigen::Vector3d& t = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  return {{"position_m", {t.x(), t.y(), t.z()}}, {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

}  // namespace

Scene Corruption::scene_before(const Scene& scene) const {
  Scene changed = scene;
  for (const MisSize& wrong : mis_sizes) changed.markers[wrong.marker].size_m = wrong.true_size_m;
  for (const Twin& twin : twins) changed.markers.push_back(twin.second);
  return changed;
}

Scene Corruption::scene_after(const Scene& scene) const {
  Scene changed = scene_before(scene);
  for (const Move& move : moves) {
    changed.markers[move.marker].world_from_marker = move.world_from_marker_after;
  }
  return changed;
}

Expected<Corruption> draw_corruption(const Scene& scene, const SimulatedRig& rig,
                                     const CapturePlan& plan, const DetectionsJob& job) {
  Corruption corruption;
  if (job.twins + job.moved + job.mis_sized == 0) return corruption;
  const Sightings seen = count_sightings(scene, rig, plan);
  Random random = Random::of({job.seed, 7});
  Lottery lottery(scene.markers.size(), random);
  // Nothing is put where something else hangs, will hang or hung: two prints can't overlap.
  Scene occupied = scene;
  const auto often = [&](std::size_t i) {
    return seen.before[i] + seen.after[i] >= kLeastSightings;
  };
  for (int i = 0; i < job.twins; ++i) {
    std::optional<PlacedMarker> second;
    const auto marker = lottery.draw([&](std::size_t candidate) {
      const PlacedMarker& first = scene.markers[candidate];
      const auto host = static_cast<std::size_t>(random.below(scene.markers.size()));
      if (!often(candidate) || !often(host)) return false;
      second = place_near(occupied, host, first, kMostMove_m, occupied.markers.size(), random);
      return second &&
             (second->world_from_marker.translation - first.world_from_marker.translation).norm() >=
                 kLeastTwinDistance_m;
    });
    if (!marker) return too_many(scene, "--twins");
    corruption.twins.push_back({*marker, *second});
    occupied.markers.push_back(*second);
  }
  const std::size_t middle = plan.exposures().back().position / 2;
  for (int i = 0; i < job.moved; ++i) {
    std::optional<PlacedMarker> after;
    const auto marker = lottery.draw([&](std::size_t candidate) {
      if (std::min(seen.before[candidate], seen.after[candidate]) < kLeastSightings) return false;
      after =
          place_near(occupied, candidate, scene.markers[candidate], kMostMove_m, candidate, random);
      return after.has_value();
    });
    if (!marker) return too_many(scene, "--moved");
    corruption.moves.push_back({*marker, after->world_from_marker, middle});
    occupied.markers.push_back(*after);
  }
  for (int i = 0; i < job.mis_sized; ++i) {
    const auto marker = lottery.draw(often);
    if (!marker) return too_many(scene, "--mis-sized");
    corruption.mis_sizes.push_back(
        {*marker, scene.markers[*marker].size_m * (random.uniform() < 0.5 ? 0.8 : 1.25)});
  }
  return corruption;
}

std::string format_corruptions(const Scene& scene, const SimulatedRig& rig, const CapturePlan& plan,
                               const Corruption& corruption, const std::vector<FalseId>& false_ids,
                               const std::vector<Exposure>& dropped_images) {
  const auto id_of = [&](std::size_t marker) {
    return scene.catalog.format(scene.markers[marker].id);
  };
  const auto image_of = [&](const Exposure& exposure) {
    return nlohmann::json{{"t_ns", exposure.stamp.count()},
                          {"camera", rig.rig.cameras[exposure.camera].name}};
  };
  nlohmann::json json = {{"schema", 1},
                         {"twins", nlohmann::json::array()},
                         {"moved", nlohmann::json::array()},
                         {"mis_sized", nlohmann::json::array()},
                         {"false_ids", nlohmann::json::array()},
                         {"dropped_images", nlohmann::json::array()}};
  for (const auto& twin : corruption.twins) {
    json["twins"].push_back(
        {{"id", id_of(twin.marker)},
         {"world_from_marker", pose_json(scene.markers[twin.marker].world_from_marker)},
         {"world_from_second", pose_json(twin.second.world_from_marker)}});
  }
  for (const auto& move : corruption.moves) {
    const auto first_after = std::find_if(
        plan.exposures().begin(), plan.exposures().end(),
        [&](const Exposure& exposure) { return exposure.position == move.from_position; });
    json["moved"].push_back({{"id", id_of(move.marker)},
                             {"before", pose_json(scene.markers[move.marker].world_from_marker)},
                             {"after", pose_json(move.world_from_marker_after)},
                             {"from_t_ns", first_after->stamp.count()}});
  }
  for (const auto& wrong : corruption.mis_sizes) {
    json["mis_sized"].push_back({{"id", id_of(wrong.marker)},
                                 {"stated_size_m", scene.markers[wrong.marker].size_m},
                                 {"true_size_m", wrong.true_size_m}});
  }
  for (const FalseId& wrong : false_ids) {
    nlohmann::json entry = image_of(wrong.exposure);
    entry["id"] = scene.catalog.format(wrong.truth);
    entry["read_as"] = scene.catalog.format(wrong.read);
    json["false_ids"].push_back(entry);
  }
  for (const Exposure& exposure : dropped_images) {
    json["dropped_images"].push_back(image_of(exposure));
  }
  return json.dump(1) + "\n";
}

}  // namespace waymark::simulator
