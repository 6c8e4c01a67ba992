#include "core/camera/kalibr_lens.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/camera/lens_kind.h"

namespace waymark {
namespace {

using Kinds = std::vector<const LensKind*>;

/// What one key may be, in the kinds' order, each once.
std::string names_of(const Kinds& kinds, std::string_view LensKind::*key) {
  std::vector<std::string_view> names;
  for (const LensKind* kind : kinds) {
    if (std::find(names.begin(), names.end(), kind->*key) == names.end()) {
      names.push_back(kind->*key);
    }
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

/// "4 numbers (k1 k2 p1 p2)" or "4 or 5 …": how many coefficients the kinds have.
std::string counts_of(const Kinds& kinds) {
  std::vector<int> counts;
  std::vector<std::string_view> names;
  for (const LensKind* kind : kinds) counts.push_back(kind->count());
  for (const LensCoefficient& one : kinds.back()->coefficients) names.push_back(one.name);
  return fmt::format("{} numbers ({})", fmt::join(counts, " or "), fmt::join(names, " "));
}

/// Reads the lens's keys of one camera.
class LensReader {
 public:
  explicit LensReader(const KalibrNode& camera) : camera_(camera) {
    for (const LensKind& kind : lens_kinds()) kinds_.push_back(&kind);
  }

  Expected<CameraParameters> read() {
    for (const auto part :
         {&LensReader::read_kinds, &LensReader::read_coefficients, &LensReader::read_intrinsics,
          &LensReader::read_resolution, &LensReader::check_order, &LensReader::read_valid_radius}) {
      if (const auto status = (this->*part)(); !status) return tl::make_unexpected(status.error());
    }
    return lens_;
  }

 private:
  /// Keeps the kinds for which a key's text stands.
  Status keep(std::string_view LensKind::*key, const char* name, const char* for_what) {
    const auto text = camera_.read_text(name);
    if (!text) return tl::make_unexpected(text.error());
    Kinds kept;
    std::copy_if(kinds_.begin(), kinds_.end(), std::back_inserter(kept),
                 [&](const LensKind* kind) { return kind->*key == *text; });
    if (kept.empty()) {
      return camera_.wrong(
          name, camera_.at(name),
          fmt::format("'{}' is not one of {}{}", *text, names_of(kinds_, key), for_what));
    }
    kinds_ = std::move(kept);
    return {};
  }

  Status read_kinds() {
    if (auto kept = keep(&LensKind::camera_model, "camera_model", ""); !kept) return kept;
    const std::string of_model = fmt::format(" of camera_model {}", kinds_.front()->camera_model);
    return keep(&LensKind::distortion_model, "distortion_model",
                kinds_.front()->in_intrinsics() ? of_model.c_str() : "");
  }

  /// By their number the kind is known.
  Status read_coefficients() {
    const YAML::Node at = camera_.at("distortion_coeffs");
    const bool empty = !at.IsDefined() || at.IsNull() || (at.IsSequence() && at.size() == 0);
    lens_.distortion = kinds_.front()->distortion;
    if (kinds_.front()->distortion_model == "none") return empty ? Status{} : check_zeros(at);
    const auto fits = std::find_if(kinds_.begin(), kinds_.end(), [&](const LensKind* kind) {
      return at.IsDefined() && at.IsSequence() && static_cast<int>(at.size()) == kind->count();
    });
    if (at.IsDefined() && at.IsSequence() && fits == kinds_.end()) {
      return camera_.wrong(
          "distortion_coeffs", at,
          fmt::format("a list of {} instead of a list of {}", at.size(), counts_of(kinds_)),
          Cause::format);
    }
    const LensKind& kind = fits == kinds_.end() ? *kinds_.front() : **fits;
    lens_.distortion = kind.distortion;
    const auto values =
        camera_.read_numbers("distortion_coeffs", at, static_cast<std::size_t>(kind.count()));
    if (!values) return tl::make_unexpected(values.error());
    std::copy(values->begin(), values->end(), lens_.coefficients.begin());
    return {};
  }

  Status check_zeros(const YAML::Node& at) const {
    const auto values =
        camera_.read_numbers("distortion_coeffs", at, at.IsSequence() ? at.size() : 4);
    if (!values) return tl::make_unexpected(values.error());
    if (std::all_of(values->begin(), values->end(), [](double c) { return c == 0; })) return {};
    return camera_.wrong("distortion_coeffs", at, "are not zero although distortion_model is none");
  }

  /// alpha beta or xi alpha stand before the four.
  Status read_intrinsics() {
    const LensKind& kind = lens_kind(lens_.distortion);
    const std::size_t before =
        kind.in_intrinsics() ? static_cast<std::size_t>(kind.count()) : std::size_t{0};
    const auto values = camera_.read_numbers("intrinsics", camera_.at("intrinsics"), before + 4);
    if (!values) return tl::make_unexpected(values.error());
    std::copy_n(values->begin(), before, lens_.coefficients.begin());
    const double* const four = values->data() + before;
    lens_.fu_px = four[0];
    lens_.fv_px = four[1];
    lens_.pu_px = four[2];
    lens_.pv_px = four[3];
    return {};
  }

  Status read_resolution() {
    const auto values = camera_.read_numbers("resolution", camera_.at("resolution"), 2);
    if (!values) return tl::make_unexpected(values.error());
    const auto width = read_size("width", (*values)[0]);
    if (!width) return tl::make_unexpected(width.error());
    const auto height = read_size("height", (*values)[1]);
    if (!height) return tl::make_unexpected(height.error());
    lens_.width_px = *width;
    lens_.height_px = *height;
    return {};
  }

  [[nodiscard]] Expected<int> read_size(std::string_view what, double value) const {
    constexpr double kMaxSize_px = 100'000;
    if (value < 1 || value > kMaxSize_px || value != std::floor(value)) {
      return camera_.wrong("resolution", camera_.at("resolution"),
                           fmt::format("{} {} is no whole number of pixels", what, value));
    }
    return static_cast<int>(value);
  }

  /// Fails where focal lengths and principal point have clearly changed places.
  Status check_order() {
    const CameraParameters& p = lens_;
    const auto off_centre = [](double at, double size) { return std::abs(at / size - 0.5); };
    constexpr double kRim = 0.45;  // of the size: nearly at the image's edge, or beyond
    constexpr double kMiddle = 0.15;
    const bool at_rim =
        off_centre(p.pu_px, p.width_px) > kRim || off_centre(p.pv_px, p.height_px) > kRim;
    const bool focal_is_middle =
        off_centre(p.fu_px, p.width_px) < kMiddle && off_centre(p.fv_px, p.height_px) < kMiddle;
    if (!at_rim || !focal_is_middle) return {};
    return camera_.wrong(
        "intrinsics", camera_.at("intrinsics"),
        fmt::format("the principal point ({:.6g}, {:.6g}) lies at or beyond the rim of "
                    "{}×{}: are they written as cx cy fx fy? Write fu fv pu pv",
                    p.pu_px, p.pv_px, p.width_px, p.height_px),
        Cause::intrinsics);
  }

  Status read_valid_radius() {
    const YAML::Node at = camera_.at("valid_radius_px");
    if (!at.IsDefined()) return {};
    const auto value = camera_.read_number("valid_radius_px", at);
    if (!value) return tl::make_unexpected(value.error());
    if (!(*value > 0)) {
      return camera_.wrong("valid_radius_px", at, fmt::format("{} is not above 0 px", *value));
    }
    lens_.valid_radius_px = *value;
    return {};
  }

  const KalibrNode& camera_;
  Kinds kinds_;
  CameraParameters lens_;
};

std::string listed(std::span<const double> numbers) {
  std::vector<std::string> texts;
  for (const double number : numbers) texts.push_back(fmt::format("{:.17g}", number));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

}  // namespace

Expected<CameraParameters> read_kalibr_lens(const KalibrNode& camera) {
  return LensReader(camera).read();
}

std::string format_kalibr_lens(const CameraParameters& p) {
  const LensKind& kind = lens_kind(p.distortion);
  std::vector<double> before(p.coefficients.begin(), p.coefficients.begin() + kind.count());
  std::vector<double> intrinsics{p.fu_px, p.fv_px, p.pu_px, p.pv_px};
  if (kind.in_intrinsics()) {
    intrinsics.insert(intrinsics.begin(), before.begin(), before.end());
    before.clear();
  }
  // Kalibr's readers ask for four of none, too.
  if (before.empty()) before.assign(4, 0.0);
  std::string text = fmt::format(
      "  camera_model: {}\n  intrinsics: {}\n  distortion_model: {}\n  distortion_coeffs: {}\n"
      "  resolution: [{}, {}]\n",
      kind.camera_model, listed(intrinsics), kind.distortion_model, listed(before), p.width_px,
      p.height_px);
  if (p.valid_radius_px) text += fmt::format("  valid_radius_px: {:.17g}\n", *p.valid_radius_px);
  return text;
}

}  // namespace waymark
