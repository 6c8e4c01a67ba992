#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "bench/locd_attacks/attack.h"
#include "core/base/check.h"

namespace waymark::bench {
namespace {

constexpr double kRad = std::numbers::pi / 180.0;

Eigen::Vector3d direction(simulator::Random& random) {
  Eigen::Vector3d v(random.normal(), random.normal(), random.normal());
  return v.normalized();
}

/// One of four markers on a pallet before the first camera.
Rigid3 cam_from_pallet_marker(std::size_t i) {
  const double x = i % 2 == 0 ? -0.28 : 0.28;
  // x right, y down, z forward; the print towards the camera.
  return {Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX())),
          {x, i < 2 ? -0.22 : 0.24, 1.6 + 0.1 * x}};
}

/// Mapped markers that are now on a pallet before the first camera; the map knows them scattered,
/// or on that pallet where it once stood.
Attack pallet(bool mapped_together, std::string name, std::vector<AlertKind> causes) {
  return {std::move(name),
          [=](World& w) {
            while (w.touched.size() < 4) {
              const std::size_t m = w.random.below(w.building.markers.size());
              if (!w.guilty_markers.insert(w.building.markers[m].id).second) continue;
              w.touched.push_back(m);
            }
            if (!mapped_together) return;
            const Rigid3 world_from_cam0 =
                simulator::Trajectory(w.building.trajectory).world_from_cam0(5);
            for (std::size_t i = 0; i < w.touched.size(); ++i) {
              w.told_map.submaps.front().markers[w.touched[i]].world_from_marker =
                  world_from_cam0 * cam_from_pallet_marker(i);
            }
          },
          [](World& w, SimulatedDrive& drive, int set) {
            simulator::Scene building = w.building;
            const Rigid3 world_from_cam0 =
                drive.world_from_rig_at_set(set) * w.rig.cameras[0].rig_from_cam;
            for (std::size_t i = 0; i < w.touched.size(); ++i) {
              building.markers[w.touched[i]].world_from_marker =
                  world_from_cam0 * cam_from_pallet_marker(i);
            }
            drive.rebuild(building);
          },
          {},
          0,
          {},
          std::move(causes),
          false};
}

Attack shelf(std::vector<AlertKind> causes) {
  return {"shelf of six moved by 0.1 m",
          [](World& w) {
            const Rigid3 centre =
                w.building.markers[w.random.below(w.building.markers.size())].world_from_marker;
            std::vector<std::pair<double, std::size_t>> near;
            for (std::size_t m = 0; m < w.building.markers.size(); ++m) {
              const Rigid3& pose = w.building.markers[m].world_from_marker;
              near.emplace_back((pose.translation - centre.translation).norm() +
                                    10 * angle_between_rad(pose.rotation, centre.rotation),
                                m);
            }
            std::sort(near.begin(), near.end());
            const Eigen::Vector3d by = 0.1 * (centre.rotation * Eigen::Vector3d::UnitX() * 0.8 +
                                              centre.rotation * Eigen::Vector3d::UnitZ() * 0.6);
            for (std::size_t i = 0; i < 6; ++i) {
              simulator::PlacedMarker& marker = w.building.markers[near[i].second];
              marker.world_from_marker.translation += by;
              w.guilty_markers.insert(marker.id);
            }
          },
          {},
          {},
          0,
          {},
          std::move(causes),
          false};
}

/// A quarter of all markers by 2–6 cm, each its own way.
Attack quarter() {
  return {"a quarter moved by 2-6 cm",
          [](World& w) {
            for (simulator::PlacedMarker& marker : w.building.markers) {
              if (w.random.uniform() >= 0.25) continue;
              Eigen::Vector3d by = w.random.uniform(0.02, 0.06) * direction(w.random);
              const Eigen::Vector3d normal =
                  marker.world_from_marker.rotation * Eigen::Vector3d::UnitZ();
              if (by.dot(normal) < 0) by -= 2 * by.dot(normal) * normal;
              marker.world_from_marker.translation += by;
              w.guilty_markers.insert(marker.id);
            }
          },
          {},
          {},
          0,
          {},
          {AlertKind::marker_moved},
          false};
}

/// The map measured by hand: each marker wrong by its stated sigma.
Attack by_hand(double sigma_m) {
  return {fmt::format("map by hand, {:.0f} mm", 1e3 * sigma_m),
          [=](World& w) {
            const double sigma_rad = std::max(0.2 * kRad, sigma_m / 0.3 * 0.3);
            w.told_map.capture_fingerprints.clear();
            for (MapMarker& marker : w.told_map.submaps.front().markers) {
              Vector6d error;
              for (int i = 0; i < 3; ++i) error[i] = sigma_m * w.random.normal();
              for (int i = 3; i < 6; ++i) error[i] = sigma_rad * w.random.normal();
              marker.world_from_marker = marker.world_from_marker.plus(error);
              marker.covariance.setZero();
              marker.covariance.diagonal() << Eigen::Vector3d::Constant(sigma_m * sigma_m),
                  Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
            }
          },
          {},
          {},
          0,
          {},
          {},
          false};
}

/// Every id of the half of the building beyond x hangs in this half a second time, in a place of
/// the same shape: the map knows one of the two.
Attack twin_place() {
  return {"twin place",
          [](World& w) {
            // The markers of one wall carry the ids of another wall's, in the same order.
            auto& markers = w.building.markers;
            std::map<int, std::vector<std::size_t>> of_surface;
            for (std::size_t m = 0; m < markers.size(); ++m) {
              of_surface[markers[m].surface].push_back(m);
            }
            const std::vector<std::size_t>* a = nullptr;
            const std::vector<std::size_t>* b = nullptr;
            for (const auto& [surface, list] : of_surface) {
              if (a == nullptr) {
                a = &list;
              } else if (b == nullptr && list.size() == a->size()) {
                b = &list;
              }
            }
            if (b == nullptr) return;
            for (std::size_t i = 0; i < a->size(); ++i) {
              w.guilty_markers.insert(markers[(*a)[i]].id);
              w.guilty_markers.insert(markers[(*b)[i]].id);
              markers[(*b)[i]].id = markers[(*a)[i]].id;
            }
          },
          {},
          {},
          0,
          {},
          {AlertKind::marker_moved},
          false};
}

/// The same ids hang in other places: another floor's map.
Attack other_floor(std::vector<AlertKind> causes) {
  return {"another floor's map",
          [](World& w) {
            auto& markers = w.told_map.submaps.front().markers;
            for (std::size_t i = markers.size(); i > 1; --i) {
              const std::size_t k = w.random.below(i);
              std::swap(markers[i - 1].world_from_marker, markers[k].world_from_marker);
            }
          },
          {},
          {},
          0,
          {},
          std::move(causes),
          false};
}

}  // namespace

std::vector<Attack> map_attacks() {
  using K = AlertKind;
  return {
      pallet(false, "four markers on a pallet", {K::marker_riding}),
      pallet(true, "pallet, mapped where it stood", {K::marker_riding}),
      shelf({K::marker_moved}),
      quarter(),
      by_hand(0.020),
      by_hand(0.010),
      by_hand(0.005),
      by_hand(0.002),
      twin_place(),
      other_floor({K::map_wrong}),
  };
}

}  // namespace waymark::bench
