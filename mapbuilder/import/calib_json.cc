#include "mapbuilder/import/calib_json.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <vector>

#include "core/base/atomic_file.h"
#include "core/base/json_fields.h"
#include "core/camera/lens_kind.h"

namespace waymark {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxBytes = std::size_t{1} << 20;
constexpr int kMaxSide_px = 1'000'000;

/// All numbers of an array, however nested, or of OpenCV's matrix object; nullopt when something
/// else stands among them. Documents nest no deeper than parse_json allows.
std::optional<std::vector<double>> flat_numbers(const json& node) {
  if (node.is_number()) return std::vector<double>{node.get<double>()};
  if (node.is_object() && node.contains("data")) return flat_numbers(node["data"]);
  if (!node.is_array()) return std::nullopt;
  std::vector<double> numbers;
  for (const json& item : node) {
    const auto inner = flat_numbers(item);
    if (!inner) return std::nullopt;
    numbers.insert(numbers.end(), inner->begin(), inner->end());
  }
  return numbers;
}

class Reader {
 public:
  Reader(JsonFields& fields, const std::string& name) : fields_(fields), name_(name) {}

  Expected<CalibJson> read() {
    for (const auto step :
         {&Reader::read_intrinsics, &Reader::read_distortion, &Reader::read_size}) {
      if (auto status = (this->*step)(); !status) return tl::make_unexpected(status.error());
    }
    return calib_;
  }

 private:
  Status read_intrinsics() {
    if (const json* matrix = first_of({"camera_matrix", "K"})) {
      const auto k = flat_numbers(*matrix);
      if (!k || k->size() != 9 || (*k)[1] != 0 || (*k)[3] != 0 || (*k)[6] != 0 || (*k)[7] != 0 ||
          (*k)[8] != 1) {
        return fail(ErrorKind::bad_data,
                    "{}: the camera matrix must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]", name_);
      }
      set_intrinsics((*k)[0], (*k)[4], (*k)[2], (*k)[5]);
      return {};
    }
    std::array<double, 4> values{};
    std::size_t i = 0;
    for (const char* key : {"fx", "fy", "cx", "cy"}) {
      const json* const value = fields_.value(key);
      if (value == nullptr || !value->is_number()) {
        return unknown_form("the intrinsics (camera_matrix, or K, or fx, fy, cx and cy)");
      }
      values[i++] = value->get<double>();
    }
    set_intrinsics(values[0], values[1], values[2], values[3]);
    return {};
  }

  void set_intrinsics(double fx, double fy, double cx, double cy) {
    calib_.fu_px = fx;
    calib_.fv_px = fy;
    calib_.pu_px = cx;
    calib_.pv_px = cy;
  }

  Status read_distortion() {
    const json* const node = first_of({"dist", "distortion"});
    if (node == nullptr) return unknown_form("the distortion (dist or distortion)");
    const auto coefficients = flat_numbers(*node);
    if (coefficients && coefficients->empty()) return {};
    const auto kind = coefficients ? radial_kind_of(*coefficients) : std::nullopt;
    if (!kind) {
      return fail(ErrorKind::bad_data,
                  "{}: the distortion must be a list of numbers, k1 k2 p1 p2 (or empty), with k3, "
                  "or with k3 k4 k5 k6; further ones must be 0",
                  name_);
    }
    calib_.distortion = *kind;
    std::copy_n(coefficients->begin(), std::min(coefficients->size(), calib_.coefficients.size()),
                calib_.coefficients.begin());
    return {};
  }

  Status read_size() {
    std::optional<std::vector<double>> size;
    if (const json* node = first_of({"resolution"})) {
      size = flat_numbers(*node);
    } else if (fields_.contains("width") && fields_.contains("height")) {
      size = flat_numbers(json::array({*fields_.value("width"), *fields_.value("height")}));
    } else {
      return {};
    }
    const auto is_side = [](double px) {
      return px >= 1 && px <= kMaxSide_px && px == std::floor(px);
    };
    if (!size || size->size() != 2 || !is_side((*size)[0]) || !is_side((*size)[1])) {
      return fail(ErrorKind::bad_data, "{}: the image size must be two whole numbers of pixels",
                  name_);
    }
    calib_.size_px = {static_cast<int>((*size)[0]), static_cast<int>((*size)[1])};
    return {};
  }

  [[nodiscard]] const json* first_of(std::initializer_list<const char*> keys) const {
    for (const char* key : keys) {
      if (const json* const found = fields_.value(key)) return found;
    }
    return nullptr;
  }

  [[nodiscard]] tl::unexpected<Error> unknown_form(const char* what) const {
    const std::vector<std::string> keys = fields_.keys();
    return fail(ErrorKind::bad_data,
                "{}: can't find {}; keys seen: {}; a rig.yaml would do instead", name_, what,
                keys.empty() ? "none" : fmt::format("{}", fmt::join(keys, ", ")));
  }

  JsonFields& fields_;
  const std::string& name_;
  CalibJson calib_;
};

}  // namespace

Expected<CalibJson> parse_calib_json(const std::string& text, const std::string& name) {
  const auto document = parse_json(text, name, kMaxBytes);
  if (!document) return tl::make_unexpected(document.error());
  JsonFields fields(*document, name);
  if (!fields.good()) return tl::make_unexpected(fields.status().error());
  return Reader(fields, name).read();
}

Expected<CalibJson> read_calib_json(const std::filesystem::path& path) {
  const auto text = read_file(path, kMaxBytes);
  if (!text) return tl::make_unexpected(text.error());
  return parse_calib_json(*text, path.string());
}

}  // namespace waymark
