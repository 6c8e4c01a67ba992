#include "mapbuilder/import/survey.h"

#include <array>

#include "core/base/toml_fields.h"

namespace waymark {
namespace {

constexpr std::array<std::string_view, 4> kCornerNames = {"top-left", "top-right", "bottom-right",
                                                          "bottom-left"};
constexpr double kSmallestSigma_m = 1e-5;
constexpr double kLargestSigma_m = 10.0;
constexpr double kLargestBuilding_m = 1e5;

class SurveyReader {
 public:
  SurveyReader(const std::string& name, std::optional<Family> default_family)
      : name_(name), default_family_(default_family) {}

  Expected<Survey> read(const toml::table& root) const {
    Survey survey;
    TomlFields fields(root, name_);
    for (const toml::table* block : fields.tables("points")) {
      auto point = read_point(*block);
      if (!point) return tl::make_unexpected(point.error());
      survey.points.push_back(*point);
    }
    for (const toml::table* block : fields.tables("distances")) {
      auto distance = read_distance(*block);
      if (!distance) return tl::make_unexpected(distance.error());
      survey.distances.push_back(*distance);
    }
    if (auto status = fields.finish(); !status) return tl::make_unexpected(status.error());
    return survey;
  }

 private:
  /// `id` and, optionally, `corner` of a table whose other keys the caller reads.
  MarkerPlace read_place(const toml::table& table, TomlFields& fields) const {
    MarkerPlace place;
    fields.allow("id");
    const toml::node* id = table.get("id");
    std::string text;
    if (id != nullptr && id->is_integer()) text = std::to_string(id->as_integer()->get());
    if (id != nullptr && id->is_string()) text = id->as_string()->get();
    if (text.empty()) {
      fields.reject("id", "id must be a marker's number, or \"family:number\"");
    } else if (auto marker = parse_marker_id(text, default_family_)) {
      place.marker = *marker;
    } else {
      fields.reject("id", marker.error().message);
    }
    const std::size_t corner = fields.choice(
        "corner", {kCornerNames[0], kCornerNames[1], kCornerNames[2], kCornerNames[3], "center"},
        4);
    if (corner < 4) place.corner = static_cast<int>(corner);
    return place;
  }

  static SurveyUse read_use(TomlFields& fields) {
    return fields.choice("use", {"fit", "check"}, 0) == 0 ? SurveyUse::fit : SurveyUse::check;
  }

  Expected<SurveyedPoint> read_point(const toml::table& block) const {
    TomlFields fields(block, name_);
    SurveyedPoint point;
    point.place = read_place(block, fields);
    point.position_m = fields.vector3("position_m");
    point.sigma_m = fields.number("sigma_m", kSmallestSigma_m, kLargestSigma_m);
    point.use = read_use(fields);
    if (point.position_m.cwiseAbs().maxCoeff() > kLargestBuilding_m) {
      fields.reject("position_m", "position_m lies more than 100 km away; it is in metres");
    }
    if (auto status = fields.finish(); !status) return tl::make_unexpected(status.error());
    return point;
  }

  Expected<SurveyedDistance> read_distance(const toml::table& block) const {
    TomlFields fields(block, name_);
    SurveyedDistance distance;
    for (auto [key, place] : {std::pair{"from", &distance.from}, std::pair{"to", &distance.to}}) {
      const toml::table* end = fields.table(key);
      if (end == nullptr) {
        fields.reject(
            fmt::format("{} is missing: {} = {{ id = 24, corner = \"center\" }}", key, key));
        continue;
      }
      TomlFields end_fields(*end, name_);
      *place = read_place(*end, end_fields);
      if (auto status = end_fields.finish(); !status) fields.reject(status.error());
    }
    distance.distance_m = fields.number("distance_m", kSmallestSigma_m, kLargestBuilding_m);
    distance.sigma_m = fields.number("sigma_m", kSmallestSigma_m, kLargestSigma_m);
    distance.use = read_use(fields);
    if (distance.from.marker == distance.to.marker && distance.from.corner == distance.to.corner) {
      fields.reject("from and to are the same place");
    }
    if (auto status = fields.finish(); !status) return tl::make_unexpected(status.error());
    return distance;
  }

  std::string name_;
  std::optional<Family> default_family_;
};

}  // namespace

Expected<Survey> parse_survey(std::string_view text, const std::string& name,
                              std::optional<Family> default_family) {
  const auto root = parse_toml(text, name);
  if (!root) return tl::make_unexpected(root.error());
  return SurveyReader(name, default_family).read(*root);
}

Expected<Survey> read_survey(const std::filesystem::path& path,
                             std::optional<Family> default_family) {
  const auto root = read_toml(path);
  if (!root) return tl::make_unexpected(root.error());
  return SurveyReader(path.string(), default_family).read(*root);
}

std::string format_place(const MarkerPlace& place, bool with_family) {
  const std::string_view corner =
      place.corner ? kCornerNames[static_cast<std::size_t>(*place.corner)] : "center";
  return fmt::format("{} {}", format_marker_id(place.marker, with_family), corner);
}

}  // namespace waymark
