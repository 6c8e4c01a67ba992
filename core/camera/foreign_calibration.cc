#include "core/camera/foreign_calibration.h"

#include <algorithm>
#include <vector>

namespace waymark {
namespace {

/// The first of the keys that is there.
YAML::Node first_of(const YAML::Node& root, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    if (const YAML::Node node = root[key]; node.IsDefined()) return node;
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

/// A matrix's numbers, row by row; empty where it is none.
std::vector<double> numbers_of(const YAML::Node& matrix) {
  const YAML::Node data = matrix.IsMap() ? matrix["data"] : matrix;
  std::vector<double> numbers;
  if (!data.IsDefined() || !data.IsSequence()) return numbers;
  for (const auto& item : data) {
    double value = 0;
    if (!item.IsScalar() || !YAML::convert<double>::decode(item, value)) return {};
    numbers.push_back(value);
  }
  return numbers;
}

/// What a camchain calls the lens; empty for one that it has no model of.
std::string distortion_model_of(const YAML::Node& root, std::size_t coefficients) {
  const YAML::Node named = root["distortion_model"];
  const std::string model = named.IsDefined() && named.IsScalar() ? named.Scalar() : "plumb_bob";
  if (model == "equidistant" || model == "fisheye") return "equidistant";
  if (model == "rational_polynomial" || coefficients > 5) return "rational";
  return model == "plumb_bob" ? "radtan" : "";
}

}  // namespace

Expected<std::optional<YAML::Node>> camchain_of_foreign(const YAML::Node& root,
                                                        const std::string& name) {
  if (!root.IsMap() || !root["camera_matrix"].IsDefined()) return std::nullopt;
  const char* kind = root["camera_name"].IsDefined() || root["projection_matrix"].IsDefined()
                         ? "a ROS camera_info"
                         : "an OpenCV FileStorage";
  const std::vector<double> k = numbers_of(root["camera_matrix"]);
  const YAML::Node width = first_of(root, {"image_width", "image_Width", "width"});
  const YAML::Node height = first_of(root, {"image_height", "image_Height", "height"});
  if (k.size() != 9 || !width.IsDefined() || !height.IsDefined()) {
    return fail(Cause::format,
                "{}: this is {}; it lacks image_width, image_height or 9 numbers of camera_matrix; "
                "write cam0: intrinsics [fu fv pu pv], resolution [w h] …",
                name, kind);
  }
  std::vector<double> coefficients =
      numbers_of(first_of(root, {"distortion_coefficients", "distortion_coeffs", "dist_coeffs"}));
  const std::string model = distortion_model_of(root, coefficients.size());
  if (model.empty()) {
    return fail(Cause::format, "{}: this is {}; its lens model '{}' is not one that is read", name,
                kind, root["distortion_model"].Scalar());
  }
  // k3 and beyond that are zero say nothing.
  while (coefficients.size() > 4 && coefficients.back() == 0) coefficients.pop_back();
  const bool straight =
      std::all_of(coefficients.begin(), coefficients.end(), [](double c) { return c == 0; });
  YAML::Node camera;
  camera["camera_model"] = "pinhole";
  camera["intrinsics"] = std::vector<double>{k[0], k[4], k[2], k[5]};
  camera["distortion_model"] = straight                                          ? "none"
                               : coefficients.size() <= 4 && model == "rational" ? "radtan"
                                                                                 : model;
  camera["distortion_coeffs"] = straight ? std::vector<double>{} : coefficients;
  camera["resolution"].push_back(width);
  camera["resolution"].push_back(height);
  YAML::Node chain;
  chain["cam0"] = camera;
  return chain;
}

std::string without_opencv_directive(std::string text) {
  constexpr std::string_view kDirective = "%YAML:1.0";
  if (text.starts_with(kDirective)) text.front() = '#';
  return text;
}

}  // namespace waymark
