#include "core/camera/camera_model.h"

#include <algorithm>
#include <cmath>

#include "core/base/range.h"
#include "core/camera/equidistant_lens.h"
#include "core/camera/lens_kind.h"
#include "core/camera/radtan_lens.h"
#include "core/camera/sphere_lenses.h"

namespace waymark {
namespace {

/// From images of a few pixels to the longest telescopes; the principal point may lie beside an
/// image that was cropped.
constexpr Range kFocal_px{1, 1e7};
constexpr Range kPrincipal_px{-1e6, 1e6};
constexpr Range kValidRadius_px{1, 1e6};
/// Of the radius where a lens's image ends: there it is not yet steep.
constexpr double kValidShare = 0.98;
/// Of the image's half diagonal: a calibration that ends nearer the axis is another lens's.
constexpr double kLeastValid = 0.4;

/// Calls `f` with the lens of that kind.
template <typename Function>
auto with_lens(Distortion distortion, const Function& f) {
  switch (distortion) {
    case Distortion::none:
      break;
    case Distortion::radtan:
      return f(RadtanLens<4>{});
    case Distortion::radtan5:
      return f(RadtanLens<5>{});
    case Distortion::rational:
      return f(RadtanLens<8>{});
    case Distortion::equidistant:
      return f(EquidistantLens{});
    case Distortion::eucm:
      return f(DividingLens<ExtendedUnifiedDepth>{});
    case Distortion::double_sphere:
      return f(DividingLens<DoubleSphereDepth>{});
  }
  return f(DividingLens<StraightDepth>{});
}

bool all_finite(const CameraParameters& p) { return intrinsics_of(p).allFinite(); }

/// Distance of the image's farthest corner from the principal point.
double farthest_corner_px(const CameraParameters& p) {
  const double x = std::max(p.pu_px + 0.5, p.width_px - 0.5 - p.pu_px);
  const double y = std::max(p.pv_px + 0.5, p.height_px - 0.5 - p.pv_px);
  return std::hypot(x, y);
}

/// bad_data for coefficients of a kind that they can't be of.
Status check_coefficients(const CameraParameters& p) {
  RangeCheck check;
  const LensKind& kind = lens_kind(p.distortion);
  for (std::size_t i = 0; i < kind.coefficients.size(); ++i) {
    check.field(kind.coefficients[i].name, p.coefficients[i], kind.coefficients[i].range);
  }
  if (const auto status = check.status(); !status) {
    return fail(ErrorKind::bad_data, "lens {}: {}", kind.name, status.error().message);
  }
  return {};
}

Status check_numbers(const CameraParameters& p) {
  if (p.width_px <= 0 || p.height_px <= 0) {
    return fail(ErrorKind::bad_data, "camera resolution {}x{} px is not positive", p.width_px,
                p.height_px);
  }
  if (!all_finite(p)) {
    return fail(ErrorKind::bad_data, "camera intrinsics or distortion coefficients are not finite");
  }
  const Status in_range = RangeCheck()
                              .field("fu", p.fu_px, kFocal_px)
                              .field("fv", p.fv_px, kFocal_px)
                              .field("pu", p.pu_px, kPrincipal_px)
                              .field("pv", p.pv_px, kPrincipal_px)
                              .status();
  if (!in_range) {
    return fail(ErrorKind::bad_data, "camera focal lengths or principal point: {} px",
                in_range.error().message);
  }
  if (p.valid_radius_px && !kValidRadius_px.contains(*p.valid_radius_px)) {
    return fail(ErrorKind::bad_data, "valid_radius_px: {} is not within {} and {} px",
                *p.valid_radius_px, kValidRadius_px.low, kValidRadius_px.high);
  }
  return check_coefficients(p);
}

}  // namespace

IntrinsicsVector intrinsics_of(const CameraParameters& parameters) {
  IntrinsicsVector all;
  all << parameters.fu_px, parameters.fv_px, parameters.pu_px, parameters.pv_px,
      Eigen::Map<const Eigen::Matrix<double, kMaxCoefficients, 1>>(parameters.coefficients.data());
  return all;
}

CameraParameters with_intrinsics(CameraParameters parameters, const IntrinsicsVector& intrinsics) {
  parameters.fu_px = intrinsics[0];
  parameters.fv_px = intrinsics[1];
  parameters.pu_px = intrinsics[2];
  parameters.pv_px = intrinsics[3];
  std::copy(intrinsics.begin() + 4, intrinsics.end(), parameters.coefficients.begin());
  return parameters;
}

CameraModel::CameraModel(const CameraParameters& parameters) : parameters_(parameters) {
  // What the kind has not is nothing.
  std::fill(parameters_.coefficients.begin() + lens_kind(parameters_.distortion).count(),
            parameters_.coefficients.end(), 0.0);
  domain_end_ = with_lens(parameters_.distortion, [&]<typename Lens>(Lens) {
    return Lens::domain_end(parameters_.coefficients);
  });
  const double image_end_px = std::min(parameters_.fu_px, parameters_.fv_px) *
                              with_lens(parameters_.distortion, [&]<typename Lens>(Lens) {
                                return Lens::image_end(parameters_.coefficients, domain_end_);
                              });
  if (kValidShare * image_end_px < farthest_corner_px(parameters_)) {
    valid_radius_px_ = kValidShare * image_end_px;
  }
  valid_radius_px_ =
      std::min(valid_radius_px_, parameters_.valid_radius_px.value_or(valid_radius_px_));
}

Expected<CameraModel> CameraModel::create(const CameraParameters& p) {
  if (const auto checked = check_numbers(p); !checked) return tl::make_unexpected(checked.error());
  const CameraModel model(p);
  const double least_px = kLeastValid * 0.5 * std::hypot(p.width_px, p.height_px);
  const bool stated = p.valid_radius_px && model.valid_radius_px() == *p.valid_radius_px;
  if (!stated && model.valid_radius_px() < least_px) {
    return fail(ErrorKind::bad_data,
                "{} distortion can't be undone farther than {:.0f} px from the principal point; "
                "the coefficients, focal lengths or resolution are another lens's",
                to_string(p.distortion), model.valid_radius_px());
  }
  return model;
}

std::optional<Eigen::Vector2d> CameraModel::project(const Eigen::Vector3d& x_in_cam) const {
  const CameraParameters& p = parameters_;
  const auto m = with_lens(p.distortion, [&]<typename Lens>(Lens) {
    return Lens::position(p.coefficients, domain_end_, x_in_cam);
  });
  if (!m) return std::nullopt;
  return Eigen::Vector2d(p.fu_px * m->x() + p.pu_px, p.fv_px * m->y() + p.pv_px);
}

std::optional<Projection> CameraModel::project_with_jacobian(
    const Eigen::Vector3d& x_in_cam, IntrinsicsJacobian* d_intrinsics) const {
  const CameraParameters& p = parameters_;
  return with_lens(p.distortion, [&]<typename Lens>(Lens) -> std::optional<Projection> {
    const auto image = Lens::image(p.coefficients, domain_end_, x_in_cam);
    if (!image) return std::nullopt;
    const Eigen::Vector2d focal(p.fu_px, p.fv_px);
    if (d_intrinsics != nullptr) {
      constexpr int kCount = Lens::kCoefficients;
      d_intrinsics->leftCols<4>() << image->position.x(), 0, 1, 0, 0, image->position.y(), 0, 1;
      if constexpr (kCount > 0) {
        d_intrinsics->template middleCols<kCount>(4) = focal.asDiagonal() * image->d_coefficients;
      }
      d_intrinsics->template rightCols<kMaxCoefficients - kCount>().setZero();
    }
    return Projection{focal.cwiseProduct(image->position) + Eigen::Vector2d(p.pu_px, p.pv_px),
                      focal.asDiagonal() * image->d_point};
  });
}

std::optional<Eigen::Vector3d> CameraModel::bearing(const Eigen::Vector2d& pixel) const {
  const CameraParameters& p = parameters_;
  if (!pixel.allFinite()) return std::nullopt;
  const Eigen::Vector2d m((pixel.x() - p.pu_px) / p.fu_px, (pixel.y() - p.pv_px) / p.fv_px);
  return with_lens(p.distortion, [&]<typename Lens>(Lens) -> std::optional<Eigen::Vector3d> {
    return Lens::bearing(p.coefficients, domain_end_, m);
  });
}

bool CameraModel::in_image(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= -0.5 && pixel.x() < parameters_.width_px - 0.5 && pixel.y() >= -0.5 &&
         pixel.y() < parameters_.height_px - 0.5;
}

}  // namespace waymark
