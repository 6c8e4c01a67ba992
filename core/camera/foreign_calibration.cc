#include "core/camera/foreign_calibration.h"

#include <algorithm>
#include <vector>

#include "core/camera/camera_sigmas.h"
#include "core/camera/lens_kind.h"

namespace waymark {
namespace {

/// The first of the keys that is there.
YAML::Node first_of(const YAML::Node& root, std::initializer_list<const char*> keys) {
  for (const char* key : keys) {
    if (const YAML::Node node = root[key]; node.IsDefined()) return node;
  }
  return YAML::Node(YAML::NodeType::Undefined);
}

/// Whether a camera of a camchain stands there: cam0, cam1, …
bool has_camera_key(const YAML::Node& root) {
  return std::any_of(root.begin(), root.end(), [](const auto& item) {
    const std::string key = item.first.IsScalar() ? item.first.Scalar() : "";
    return key.size() > 3 && key.starts_with("cam") && key[3] >= '0' && key[3] <= '9';
  });
}

/// A matrix's numbers, row by row; nullopt where it is none.
std::optional<std::vector<double>> numbers_of(const YAML::Node& matrix) {
  if (!matrix.IsDefined()) return std::nullopt;
  const YAML::Node data = matrix.IsMap() ? matrix["data"] : matrix;
  if (!data.IsDefined() || !data.IsSequence()) return std::nullopt;
  std::vector<double> numbers;
  for (const auto& item : data) {
    double value = 0;
    if (!item.IsScalar() || !YAML::convert<double>::decode(item, value)) return std::nullopt;
    numbers.push_back(value);
  }
  return numbers;
}

/// Whether 9 numbers are fu 0 pu, 0 fv pv, 0 0 1.
bool is_camera_matrix(const std::vector<double>& k) {
  return k[1] == 0 && k[3] == 0 && k[6] == 0 && k[7] == 0 && k[8] == 1;
}

/// A lens by the names of a camchain.
struct ForeignLens {
  std::string model;
  std::vector<double> coefficients;
};

/// The lens of one foreign calibration; `kind` names its program.
class ForeignLensReader {
 public:
  ForeignLensReader(const std::string& name, const char* kind) : name_(name), kind_(kind) {}

  Expected<ForeignLens> read(const YAML::Node& root) const {
    const auto model = read_model(root["distortion_model"]);
    if (!model) return tl::make_unexpected(model.error());
    auto coefficients = read_coefficients(root, *model);
    if (!coefficients) return tl::make_unexpected(coefficients.error());
    return lens_of(*model, *std::move(coefficients));
  }

 private:
  template <typename... Args>
  [[nodiscard]] auto wrong(fmt::format_string<Args...> text, Args&&... args) const {
    return fail(Cause::format, "{}: this is {}; {}", name_, kind_,
                fmt::format(text, std::forward<Args>(args)...));
  }

  /// plumb_bob, which is OpenCV's default, rational_polynomial or equidistant.
  Expected<std::string> read_model(const YAML::Node& named) const {
    if (!named.IsDefined()) return "plumb_bob";
    const std::string model = named.IsScalar() ? named.Scalar() : "";
    if (model == "fisheye") return "equidistant";
    for (const char* known : {"plumb_bob", "rational_polynomial", "equidistant"}) {
      if (model == known) return model;
    }
    return wrong("its lens model '{}' is not one that is read", model);
  }

  Expected<std::vector<double>> read_coefficients(const YAML::Node& root,
                                                  const std::string& model) const {
    const YAML::Node at =
        first_of(root, {"distortion_coefficients", "distortion_coeffs", "dist_coeffs"});
    if (!at.IsDefined()) {
      return wrong("it lacks distortion_coefficients; write data: [0, 0, 0, 0] for none");
    }
    auto numbers = numbers_of(at);
    if (!numbers) return wrong("its distortion coefficients are no list of numbers");
    // k3 and beyond that are zero say nothing.
    while (numbers->size() > 4 && numbers->back() == 0) numbers->pop_back();
    const bool none = numbers->empty() && model == "plumb_bob";
    if (!none && (numbers->size() < 4 || (model == "equidistant" && numbers->size() != 4))) {
      return wrong("{} distortion coefficients of the lens model {}; write 4", numbers->size(),
                   model);
    }
    if (!none && !radial_kind_of(*numbers)) {
      return wrong("distortion coefficient {} is {:g}; of a lens, 8 are read (OpenCV's order)",
                   numbers->size(), numbers->back());
    }
    return *std::move(numbers);
  }

  /// The least of the models that holds them.
  static ForeignLens lens_of(const std::string& model, std::vector<double> coefficients) {
    if (model == "equidistant") return {"equidistant", std::move(coefficients)};
    if (std::all_of(coefficients.begin(), coefficients.end(), [](double c) { return c == 0; })) {
      return {"none", {}};
    }
    const LensKind& kind = lens_kind(radial_kind_of(coefficients).value());
    coefficients.resize(kind.coefficients.size(), 0.0);
    return {std::string(kind.distortion_model), std::move(coefficients)};
  }

  const std::string& name_;
  const char* kind_;
};

}  // namespace

Expected<std::optional<YAML::Node>> camchain_of_foreign(const YAML::Node& root,
                                                        const std::string& name) {
  if (!root.IsMap() || !root["camera_matrix"].IsDefined() || has_camera_key(root)) {
    return std::nullopt;
  }
  const char* kind = root["camera_name"].IsDefined() || root["projection_matrix"].IsDefined()
                         ? "a ROS camera_info"
                         : "an OpenCV FileStorage";
  const auto k = numbers_of(root["camera_matrix"]);
  const YAML::Node width = first_of(root, {"image_width", "image_Width", "width"});
  const YAML::Node height = first_of(root, {"image_height", "image_Height", "height"});
  if (!k || k->size() != 9 || !width.IsDefined() || !height.IsDefined()) {
    return fail(Cause::format,
                "{}: this is {}; it lacks image_width, image_height or 9 numbers of camera_matrix; "
                "write cam0: intrinsics [fu fv pu pv], resolution [w h] …",
                name, kind);
  }
  if (!is_camera_matrix(*k)) {
    return fail(Cause::format,
                "{}: this is {}; its camera_matrix is not fu 0 pu, 0 fv pv, 0 0 1: {:g}", name,
                kind, fmt::join(*k, ", "));
  }
  const auto lens = ForeignLensReader(name, kind).read(root);
  if (!lens) return tl::make_unexpected(lens.error());
  YAML::Node camera;
  camera["camera_model"] = "pinhole";
  camera["intrinsics"] = std::vector<double>{(*k)[0], (*k)[4], (*k)[2], (*k)[5]};
  camera["distortion_model"] = lens->model;
  camera["distortion_coeffs"] = lens->coefficients;
  camera["resolution"].push_back(width);
  camera["resolution"].push_back(height);
  camera["sigma_source"] = std::string(to_string(SigmaSource::opencv));
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
