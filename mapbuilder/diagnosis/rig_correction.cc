#include "mapbuilder/diagnosis/rig_correction.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "core/camera/lens_kind.h"

namespace waymark {
namespace {

bool concerns(const RigExplanation& explanation, int camera) {
  return std::find(explanation.cameras.begin(), explanation.cameras.end(),
                   static_cast<std::size_t>(camera)) != explanation.cameras.end();
}

void leave_out(const RigExplanation& explanation, DetectedCapture& capture) {
  std::erase_if(capture.images, [&](const ImageDetections& image) {
    return concerns(explanation, image.camera) &&
           (!explanation.since || image.stamp >= *explanation.since - capture.sync_tolerance);
  });
}

/// The images of two cameras change places.
void exchange(std::size_t a, std::size_t b, DetectedCapture& capture, LensEvidence& evidence) {
  for (ImageDetections& image : capture.images) {
    if (image.camera == static_cast<int>(a)) {
      image.camera = static_cast<int>(b);
    } else if (image.camera == static_cast<int>(b)) {
      image.camera = static_cast<int>(a);
    }
  }
  std::stable_sort(capture.images.begin(), capture.images.end(),
                   [](const ImageDetections& x, const ImageDetections& y) {
                     return std::pair(x.stamp, x.camera) < std::pair(y.stamp, y.camera);
                   });
  if (!evidence.empty()) std::swap(evidence[a], evidence[b]);
}

/// The camera whose images are turned by 180° in its driver.
CameraParameters turned_by_half(CameraParameters p) {
  p.pu_px = p.width_px - 1 - p.pu_px;
  p.pv_px = p.height_px - 1 - p.pv_px;
  const auto names = lens_kind(p.distortion).coefficients;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (names[k].name.starts_with('p')) p.coefficients[k] *= -1;  // p1 and p2 turn with the image
  }
  return p;
}

/// Cameras and their lenses, exactly: not as a fitted lens has seen them.
void turn_cameras(const std::vector<std::size_t>& cameras, Rig& rig) {
  const Rigid3 half{Eigen::Quaterniond(0, 0, 0, 1), Eigen::Vector3d::Zero()};
  for (const std::size_t k : cameras) {
    rig.cameras[k].rig_from_cam = rig.cameras[k].rig_from_cam * half;
    auto model = CameraModel::create(turned_by_half(rig.cameras[k].model.parameters()));
    if (model) rig.cameras[k].model = *std::move(model);
  }
}

std::string names_of(const std::vector<std::size_t>& cameras, const Rig& rig) {
  std::vector<std::string> names;
  for (const std::size_t k : cameras) names.push_back(rig.cameras[k].name);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// The other cause that looks alike: one of the two remedies helps, both together don't.
void add_alternative(const RigExplanation::Alternative& other, const Rig& rig, Finding& finding) {
  if (other.detail.empty()) return;
  finding.text += fmt::format(" Or, which looks alike, [{}] {}: {}{}", name_of(other.cause),
                              names_of(other.cameras, rig), other.detail,
                              other.detail.ends_with('?') ? "" : ".");
  finding.remedy =
      fmt::format("Do one of the two. Either: {} Or: {}", finding.remedy, other.remedy);
  for (const std::size_t k : other.cameras) finding.cameras.push_back(rig.cameras[k].name);
  std::sort(finding.cameras.begin(), finding.cameras.end());
  finding.cameras.erase(std::unique(finding.cameras.begin(), finding.cameras.end()),
                        finding.cameras.end());
}

}  // namespace

Finding finding_of(const RigExplanation& explanation, const Rig& rig) {
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = explanation.cause;
  for (const std::size_t k : explanation.cameras) finding.cameras.push_back(rig.cameras[k].name);
  finding.subject = names_of(explanation.cameras, rig);
  finding.text = explanation.detail + (explanation.detail.ends_with('?') ? "" : ".");
  finding.remedy = explanation.remedy;
  add_alternative(explanation.alternative, rig, finding);
  finding.explains =
      "every image alone fits the map, and together they fit with this and not as stated";
  if (explanation.sigma > 0 || explanation.value != 0) {
    finding.figures = {{"fitted", explanation.value, explanation.unit, explanation.sigma}};
  }
  return finding;
}

void put_right(const RigExplanation& explanation, DetectedCapture& capture,
               LensEvidence& evidence) {
  if (explanation.leave_out) return leave_out(explanation, capture);
  if (explanation.exchanges_lenses) {
    return exchange(explanation.cameras[0], explanation.cameras[1], capture, evidence);
  }
  if (explanation.turns_lenses) return turn_cameras(explanation.cameras, capture.rig);
  for (std::size_t k = 0; k < capture.rig.cameras.size(); ++k) {
    capture.rig.cameras[k].rig_from_cam = explanation.rig_from_cam[k];
  }
}

}  // namespace waymark
