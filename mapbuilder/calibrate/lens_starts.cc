#include "mapbuilder/calibrate/lens_starts.h"

#include <algorithm>
#include <limits>

#include "core/camera/lens_kind.h"
#include "mapbuilder/diagnosis/lens_of_squares.h"

namespace waymark {
namespace {

/// What a camera of which nothing is known would be of that kind: 53° across of a straight lens,
/// 115° of a fisheye.
CameraParameters middling_lens(const CameraParameters& known, Distortion kind) {
  CameraParameters lens = known;
  lens.distortion = kind;
  lens.coefficients = usual_coefficients(kind);
  const double longer_px = std::max(known.width_px, known.height_px);
  lens.fu_px = lens.fv_px =
      (bends_by_angle(kind) ? 0.5 : 1.0) * longer_px / focal_share_at_axis(lens);
  lens.pu_px = 0.5 * (known.width_px - 1);
  lens.pv_px = 0.5 * (known.height_px - 1);
  return lens;
}

/// Whether numbers of one kind are numbers of the other: coefficients that a polynomial has more
/// are zero, and a lens stated straight is a radtan one that does not bend.
bool is_of_kind(const CameraParameters& known, Distortion kind) {
  return bends_by_angle(known.distortion) ? known.distortion == kind : !bends_by_angle(kind);
}

CameraParameters with_focal(CameraParameters lens, double factor) {
  lens.fu_px *= factor;
  lens.fv_px *= factor;
  lens.coefficients = usual_coefficients(lens.distortion);
  return lens;
}

}  // namespace

LensStarts lens_starts(const CameraParameters& known, Distortion kind,
                       std::span<const ImageCorners> outlines) {
  CameraParameters first = is_of_kind(known, kind) ? known : middling_lens(known, kind);
  first.distortion = kind;
  LensStarts starts{{}, std::numeric_limits<double>::infinity()};
  if (const auto model = CameraModel::create(first)) {
    if (const auto judged = judge_lens(*model, outlines)) {
      starts.lenses.push_back(judged->best.parameters);
      starts.own_px = judged->best.own_px;
    }
  }
  if (is_of_kind(known, kind) && known.distortion != Distortion::none) {
    starts.lenses.push_back(first);
  }
  const CameraParameters middling = middling_lens(known, kind);
  for (const double factor : {1.0, 0.7, 1.4, 0.5, 2.0}) {
    starts.lenses.push_back(with_focal(middling, factor));
  }
  return starts;
}

}  // namespace waymark
