#include "core/camera/lens_kind.h"

#include <algorithm>
#include <array>
#include <limits>

namespace waymark {
namespace {

/// Any number: polynomials of telescopes have coefficients of thousands.
constexpr Range kAny{-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
constexpr Range kShare{0, 1};
/// Kalibr's start is 1; lenses have 0.3 to 3.
constexpr Range kBeta{1e-6, 100};
/// Below −1 the axis itself lies behind the second sphere; lenses have −0.4 to 0.4.
constexpr Range kXi{-0.99, 1};

constexpr LensCoefficient radial(std::string_view name) { return {name, kAny, 0, 0, 0.5}; }
constexpr LensCoefficient tangential(std::string_view name) { return {name, kAny, 0, 0, 0.05}; }
constexpr LensCoefficient angular(std::string_view name) { return {name, kAny, 0, 0, 0.2}; }

constexpr std::array kRadial{radial("k1"), radial("k2"), tangential("p1"), tangential("p2"),
                             radial("k3"), radial("k4"), radial("k5"),     radial("k6")};
constexpr std::array kAngular{angular("k1"), angular("k2"), angular("k3"), angular("k4")};
constexpr std::array kEucm{LensCoefficient{"alpha", kShare, 0, 0.6, 0.2},
                           LensCoefficient{"beta", kBeta, 1, 1, 0.5}};
constexpr std::array kDoubleSphere{LensCoefficient{"xi", kXi, 0, -0.2, 0.2},
                                   LensCoefficient{"alpha", kShare, 0, 0.6, 0.2}};

constexpr std::span<const LensCoefficient> first_radial(std::size_t count) {
  return std::span<const LensCoefficient>(kRadial).first(count);
}

const std::array<LensKind, 7> kKinds{{
    {Distortion::none, "none", "pinhole", "none", {}, -1},
    {Distortion::radtan, "radtan", "pinhole", "radtan", first_radial(4), 0},
    {Distortion::radtan5, "radtan5", "pinhole", "radtan", first_radial(5), 0},
    {Distortion::rational, "rational", "pinhole", "rational", first_radial(8), 0},
    {Distortion::equidistant, "equidistant", "pinhole", "equidistant", kAngular, 0},
    {Distortion::eucm, "eucm", "eucm", "none", kEucm, 0},
    {Distortion::double_sphere, "ds", "ds", "none", kDoubleSphere, 1},
}};

LensCoefficients all_of(Distortion distortion, double LensCoefficient::*value) {
  LensCoefficients all{};
  const LensKind& kind = lens_kind(distortion);
  std::transform(kind.coefficients.begin(), kind.coefficients.end(), all.begin(),
                 [&](const LensCoefficient& one) { return one.*value; });
  return all;
}

}  // namespace

std::span<const LensKind> lens_kinds() { return kKinds; }

const LensKind& lens_kind(Distortion distortion) {
  return kKinds.at(static_cast<std::size_t>(distortion));
}

std::string_view to_string(Distortion distortion) { return lens_kind(distortion).name; }

LensCoefficients plain_coefficients(Distortion distortion) {
  return all_of(distortion, &LensCoefficient::plain);
}

LensCoefficients usual_coefficients(Distortion distortion) {
  return all_of(distortion, &LensCoefficient::usual);
}

std::optional<Distortion> radial_kind_of(std::span<const double> coefficients) {
  if (coefficients.size() < 4) return std::nullopt;
  while (coefficients.size() > 4 && coefficients.back() == 0) {
    coefficients = coefficients.first(coefficients.size() - 1);
  }
  for (const Distortion kind : {Distortion::radtan, Distortion::radtan5, Distortion::rational}) {
    if (coefficients.size() <= lens_kind(kind).coefficients.size()) return kind;
  }
  return std::nullopt;
}

bool bends_by_angle(Distortion distortion) {
  return distortion == Distortion::equidistant || lens_kind(distortion).in_intrinsics();
}

double focal_share_at_axis(const CameraParameters& parameters) {
  if (parameters.distortion != Distortion::double_sphere) return 1;
  return 1 / (1 + parameters.coefficients[0]);
}

bool is_straight(const CameraParameters& parameters) {
  return parameters.distortion != Distortion::equidistant &&
         parameters.coefficients == plain_coefficients(parameters.distortion);
}

}  // namespace waymark
