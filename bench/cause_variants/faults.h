#pragma once

#include <span>
#include <vector>

#include "bench/cause_variants/variant.h"

namespace waymark::bench {

/// One way in which a cause shows.
struct Fault {
  Cause cause;
  const char* name;         ///< "one camera's clock late"
  std::size_t cameras = 1;  ///< that its rig has at least
  bool driving = false;     ///< told by motion only
  /// Does it to a sound world, by drawn amount, sign and camera, and says what is right then;
  /// false: this world does not show it (no marker is seen often enough), draw another.
  bool (*commit)(Variant&, simulator::Random&) = nullptr;
};

[[nodiscard]] std::span<const Fault> input_faults();
[[nodiscard]] std::span<const Fault> time_faults();
[[nodiscard]] std::span<const Fault> rig_faults();
[[nodiscard]] std::span<const Fault> lens_faults();
[[nodiscard]] std::span<const Fault> size_faults();
[[nodiscard]] std::span<const Fault> marker_faults();
[[nodiscard]] std::span<const Fault> map_faults();
[[nodiscard]] std::span<const Fault> survey_faults();

/// All of them, in this order.
[[nodiscard]] std::vector<Fault> all_faults();

/// A cause that corners can't show, and why.
struct NotShown {
  Cause cause;
  const char* why;
};
[[nodiscard]] std::span<const NotShown> not_shown();

/// Variant number `number` of a fault, the same each time: rigs and scenes in turn, the rest drawn.
[[nodiscard]] Variant draw_variant(const Fault& fault, int number);
/// Sound capture number `number`: scenes and rigs in turn, standing or driving, every third with a
/// survey, every seventh localized in a map by hand.
[[nodiscard]] Variant draw_sound(int number);

// What several faults draw.

/// Two cameras of which only the difference shows, or the one.
[[nodiscard]] std::set<std::string> one_or_either(const World& world, std::size_t camera);
[[nodiscard]] std::set<std::string> every_camera(const World& world);
/// One of the values, or its opposite.
[[nodiscard]] double either_sign(double least, double most, simulator::Random& random);
/// Different markers (index in the scene) that are seen in so many images at least; fewer where
/// there are not so many.
[[nodiscard]] std::vector<std::size_t> often_seen(const World& world, int sights, std::size_t count,
                                                  simulator::Random& random);
/// A survey of seven points and three distances (m, sigma 3 mm) on markers that are seen often.
struct Measured {
  struct Point {
    std::size_t marker;
    Eigen::Vector3d position_m;
  };
  struct Distance {
    std::size_t from, to;
    double distance_m;
  };
  std::vector<Point> points;
  std::vector<Distance> distances;
};
[[nodiscard]] std::optional<Measured> measure(const World& world, simulator::Random& random);
[[nodiscard]] std::string survey_toml(const World& world, const Measured& measured,
                                      const char* corner = "center");
/// The scene's markers as somebody measures them, within 3 mm and 0.2°.
struct HandMap {
  struct Entry {
    MarkerId id;
    double size_m;
    Rigid3 world_from_marker;
  };
  std::vector<Entry> entries;
};
[[nodiscard]] HandMap measured_map(const World& world, simulator::Random& random);
[[nodiscard]] std::string hall_json(const HandMap& map);

}  // namespace waymark::bench
