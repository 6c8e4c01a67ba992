#include "simulator/scene_file.h"

#include <algorithm>
#include <set>
#include <sstream>

#include "core/base/atomic_file.h"
#include "core/base/toml_fields.h"
#include "simulator/occlusion.h"
#include "simulator/scene_layout.h"

namespace waymark::simulator {
namespace {

constexpr double kLargest_m = 2000.0;

/// A rig has a size: the way keeps this far from everything.
constexpr double kLeastClearance_m = 0.25;
constexpr double kClearanceStep_m = 0.05;

/// Reads one scene; every step stops at the first error.
class SceneReader {
 public:
  SceneReader(const toml::table& root, const std::string& name) : root_(root), name_(name) {}

  Expected<Scene> read() {
    TomlFields fields(root_, name_);
    scene_.name = fields.text("name");
    scene_.title = fields.text("title");
    scene_.seed = static_cast<std::uint64_t>(fields.integer("seed", 0, 1'000'000'000, 1));
    scene_.room_size_m = fields.vector3("room_size_m");
    if (!(scene_.room_size_m.minCoeff() > 0 && scene_.room_size_m.maxCoeff() <= kLargest_m)) {
      fields.reject(fmt::format("room_size_m must be above 0 and at most {} m", kLargest_m));
    }
    const auto boxes = fields.tables("boxes");
    const auto walls = fields.tables("walls");
    const auto grids = fields.tables("marker_grids");
    const auto ids = fields.tables("ids");
    const toml::table* light = fields.table("light");
    const toml::table* trajectory = fields.table("trajectory");
    const toml::node* markers = root_.get("markers");
    if (markers == nullptr) {
      fields.reject("no [markers] block with the family and sizes, as in markers.toml");
    }
    if (trajectory == nullptr) fields.reject("no [trajectory] block");
    fields.allow("markers");
    if (auto status = fields.finish(); !status) return tl::make_unexpected(status.error());

    scene_.surfaces = room_faces(scene_.room_size_m);
    Status status = read_each(boxes, [this](const toml::table& t) { return add_boxes(t); });
    if (status) status = read_each(walls, [this](const toml::table& t) { return add_wall(t); });
    if (status) status = read_catalog(*markers);
    if (status) status = read_each(ids, [this](const toml::table& t) { return add_ids(t); });
    if (status) status = read_each(grids, [this](const toml::table& t) { return add_grid(t); });
    if (status) status = place_markers(scene_, grids_, ids_);
    if (status) status = read_light(light);
    if (status) status = read_trajectory(*trajectory);
    if (status) status = check_way();
    if (!status) return tl::make_unexpected(status.error());
    return std::move(scene_);
  }

 private:
  template <typename Read>
  static Status read_each(const std::vector<const toml::table*>& tables, const Read& read) {
    for (const toml::table* table : tables) {
      if (auto status = read(*table); !status) return status;
    }
    return {};
  }

  /// [[boxes]] name, min_m, max_m, and for a row of equal ones: repeat, step_m.
  Status add_boxes(const toml::table& table) {
    TomlFields fields(table, name_);
    const std::string name = fields.text("name");
    const Eigen::Vector3d min_m = fields.vector3("min_m");
    const Eigen::Vector3d max_m = fields.vector3("max_m");
    const int repeat = fields.integer("repeat", 1, 10000, 1);
    const Eigen::Vector3d step_m = fields.vector3("step_m", Eigen::Vector3d::Zero());
    if (!((max_m - min_m).minCoeff() > 0)) fields.reject("max_m must lie above min_m on each axis");
    const Eigen::Vector3d last_m = (repeat - 1) * step_m;
    if (min_m.cwiseMin(min_m + last_m).minCoeff() < 0 ||
        (scene_.room_size_m - max_m.cwiseMax(max_m + last_m)).minCoeff() < 0) {
      fields.reject(fmt::format("box \"{}\" reaches out of the room", name));
    }
    if (auto status = fields.finish(); !status) return status;
    for (int i = 0; i < repeat; ++i) {
      const Box box{repeat > 1 ? fmt::format("{}{}", name, i) : name, min_m + i * step_m,
                    max_m + i * step_m};
      for (Surface& face : box_faces(box)) scene_.surfaces.push_back(std::move(face));
      scene_.boxes.push_back(box);
    }
    return {};
  }

  /// [[walls]] name, from_m, to_m (x, y), bottom_m, top_m: thin, seen from both sides.
  Status add_wall(const toml::table& table) {
    TomlFields fields(table, name_);
    const std::string name = fields.text("name");
    const auto from = fields.numbers("from_m", 2);
    const auto to = fields.numbers("to_m", 2);
    const double height_m = scene_.room_size_m.z();
    const double bottom_m = fields.number("bottom_m", 0, height_m, 0.0);
    const double top_m = fields.number("top_m", 0, height_m, height_m);
    if (from == to || top_m <= bottom_m) fields.reject("the wall has no area");
    if (auto status = fields.finish(); !status) return status;
    const auto faces =
        wall_faces(name, {from[0], from[1], bottom_m}, {to[0], to[1], bottom_m}, top_m);
    scene_.surfaces.insert(scene_.surfaces.end(), faces.begin(), faces.end());
    scene_.walls.push_back(faces.front());
    return {};
  }

  /// The [markers] block is markers.toml itself, so its reader reads it.
  Status read_catalog(const toml::node& markers) {
    toml::table alone;
    alone.insert("markers", markers);
    std::ostringstream text;
    text << alone;
    auto catalog = parse_marker_catalog(text.str(), name_ + " [markers]");
    if (!catalog) return tl::make_unexpected(catalog.error());
    scene_.catalog = std::move(*catalog);
    return {};
  }

  /// [[ids]] first, last, and family where several meet.
  Status add_ids(const toml::table& table) {
    TomlFields fields(table, name_);
    const Family first_family = scene_.catalog.entries().front().family;
    const std::string family_name = fields.text("family", std::string(name_of(first_family)));
    const auto family = family_from_name(family_name);
    if (!family) {
      fields.reject(fmt::format("unknown family \"{}\"", family_name));
      return fields.finish();
    }
    const int last_id = traits(*family).id_count - 1;
    const int first = fields.integer("first", 0, last_id);
    const int last = fields.integer("last", first, last_id);
    for (int number = first; number <= last; ++number) {
      if (!used_ids_.insert({*family, number}).second) {
        fields.reject(fmt::format("id {} stands in two ranges", number));
        break;
      }
      ids_.push_back({*family, number});
    }
    return fields.finish();
  }

  Status add_grid(const toml::table& table) {
    TomlFields fields(table, name_);
    MarkerGrid grid;
    grid.on = fields.text("on");
    grid.rows_m = fields.numbers("rows_m", 0);
    grid.columns = fields.integer("columns", 1, 100000, grid.columns);
    const double margin_m = fields.number("margin_m", 0, kLargest_m, 0.5);
    grid.margin_left_m = fields.number("margin_left_m", 0, kLargest_m, margin_m);
    grid.margin_right_m = fields.number("margin_right_m", 0, kLargest_m, margin_m);
    grid.stagger_m = fields.number("stagger_m", -10, 10, grid.stagger_m);
    grid.jitter_m = fields.number("jitter_m", 0, 1, grid.jitter_m);
    grid.roll_sigma_deg = fields.number("roll_sigma_deg", 0, 180, grid.roll_sigma_deg);
    grid.tilt_sigma_deg = fields.number("tilt_sigma_deg", 0, 5, grid.tilt_sigma_deg);
    grids_.push_back(grid);
    return fields.finish();
  }

  /// [light] ambient, lamps = [columns, rows] below the ceiling, lamp_strength, shadow_depth.
  Status read_light(const toml::table* table) {
    const toml::table none;
    TomlFields fields(table != nullptr ? *table : none, name_);
    Lighting& light = scene_.lighting;
    light.ambient = fields.number("ambient", 0, 10, light.ambient);
    light.shadow_depth = fields.number("shadow_depth", 0, 1, light.shadow_depth);
    const auto grid = fields.numbers("lamps", 2, std::vector<double>{2, 2});
    const double strength = fields.number("lamp_strength", 0, 1000, 2.0);
    const double below_m = fields.number("lamp_below_ceiling_m", 0, 100, 0.1);
    for (double i = 0.5; i < grid[0]; ++i) {
      for (double j = 0.5; j < grid[1]; ++j) {
        light.lamps.push_back(
            {{scene_.room_size_m.x() * i / grid[0], scene_.room_size_m.y() * j / grid[1],
              scene_.room_size_m.z() - below_m},
             strength});
      }
    }
    return fields.finish();
  }

  Status read_trajectory(const toml::table& table) {
    TomlFields fields(table, name_);
    TrajectoryPlan& plan = scene_.trajectory;
    plan.positions = fields.integer("positions", 1, 1'000'000);
    plan.speed_mps = fields.number("speed_mps", 0.001, 50, plan.speed_mps);
    const std::string look_from = fields.text("look_from", "travel");
    plan.look_from_travel = look_from == "travel";
    if (look_from != "travel" && look_from != "world") {
      fields.reject("look_from must be \"travel\" or \"world\"");
    }
    const auto waypoints = fields.tables("waypoints");
    const auto lanes = fields.tables("lanes");
    if (auto status = fields.finish(); !status) return status;
    if (auto status =
            read_each(waypoints, [this](const toml::table& t) { return add_waypoint(t); });
        !status) {
      return status;
    }
    if (auto status = read_each(lanes, [this](const toml::table& t) { return add_lanes(t); });
        !status) {
      return status;
    }
    if (plan.waypoints.size() < 3) fields.reject("a way needs 3 waypoints or more");
    for (std::size_t i = 0; i < plan.waypoints.size(); ++i) {
      const Waypoint& next = plan.waypoints[(i + 1) % plan.waypoints.size()];
      if ((plan.waypoints[i].at_m - next.at_m).norm() < 0.01) {
        fields.reject("two neighbouring waypoints are the same");
      }
    }
    return fields.finish();
  }

  Status add_waypoint(const toml::table& table) {
    TomlFields fields(table, name_);
    Waypoint point;
    point.at_m = fields.vector3("at_m");
    point.look_deg = fields.number("look_deg", -360, 360, 0.0);
    point.pitch_deg = fields.number("pitch_deg", -80, 80, 0.0);
    scene_.trajectory.waypoints.push_back(point);
    return fields.finish();
  }

  /// [[trajectory.lanes]]: parallel lanes driven to and fro, as through the aisles of a warehouse,
  /// looking `sway_deg` to the left and to the right of the way in turn.
  Status add_lanes(const toml::table& table) {
    TomlFields fields(table, name_);
    const Eigen::Vector3d first_m = fields.vector3("first_m");
    const Eigen::Vector3d along_m = fields.vector3("along_m");
    const Eigen::Vector3d step_m = fields.vector3("step_m");
    const int count = fields.integer("count", 1, 10000);
    const int points = fields.integer("points_per_lane", 2, 1000, 4);
    const double sway_deg = fields.number("sway_deg", 0, 90, 0.0);
    for (int lane = 0; lane < count; ++lane) {
      for (int i = 0; i < points; ++i) {
        const double share = static_cast<double>(lane % 2 == 0 ? i : points - 1 - i) / (points - 1);
        scene_.trajectory.waypoints.push_back(
            {first_m + lane * step_m + share * along_m, i % 2 == 0 ? sway_deg : -sway_deg, 0.0});
      }
    }
    return fields.finish();
  }

  Status check_way() const {
    const Trajectory way(scene_.trajectory);
    Eigen::Vector3d before = way.position_m(0);
    for (double arc_m = 0; arc_m <= way.length_m(); arc_m += kClearanceStep_m) {
      const Eigen::Vector3d here = way.position_m(arc_m);
      if (clearance_m(scene_, here) < kLeastClearance_m ||
          is_occluded(occluders_near(scene_, here, 1.0), before, here)) {
        return fail(
            ErrorKind::bad_data,
            "{}: the way leads through a wall or closer than {} m to one at ({:.2f}, {:.2f}, "
            "{:.2f}) m; move its waypoints",
            name_, kLeastClearance_m, here.x(), here.y(), here.z());
      }
      before = here;
    }
    return {};
  }

  const toml::table& root_;
  const std::string& name_;
  Scene scene_;
  std::vector<MarkerGrid> grids_;
  std::vector<MarkerId> ids_;
  std::set<MarkerId> used_ids_;
};

}  // namespace

Expected<Scene> parse_scene(std::string_view text, const std::string& name) {
  const auto root = parse_toml(text, name);
  if (!root) return tl::make_unexpected(root.error());
  return SceneReader(*root, name).read();
}

Expected<Scene> read_scene(const std::filesystem::path& path) {
  const auto text = read_file(path, kMaxTomlBytes);
  if (!text) return tl::make_unexpected(text.error());
  return parse_scene(*text, path.string());
}

}  // namespace waymark::simulator
