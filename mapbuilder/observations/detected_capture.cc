#include "mapbuilder/observations/detected_capture.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <tuple>

namespace waymark {
namespace {

/// Streaming hash of plain numbers and text.
class Fingerprint {
 public:
  void add(double value) { append(&value, sizeof value); }
  void add(std::int64_t value) { append(&value, sizeof value); }
  void add(std::string_view text) {
    add(static_cast<std::int64_t>(text.size()));
    append(text.data(), text.size());
  }
  void add(const Eigen::Ref<const Eigen::VectorXd>& values) {
    for (const double value : values) add(value);
  }
  [[nodiscard]] std::string hexadecimal() const {
    return fmt::format("{:016x}", XXH3_64bits(bytes_.data(), bytes_.size()));
  }

 private:
  void append(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }
  std::string bytes_;
};

auto corner_key(const Detection& d) {
  return std::make_tuple(d.marker, d.corners[0].x(), d.corners[0].y(), d.corners[2].x(),
                         d.corners[2].y());
}

}  // namespace

std::vector<const Detection*> in_canonical_order(const std::vector<Detection>& detections) {
  std::vector<const Detection*> sorted;
  for (const Detection& d : detections) sorted.push_back(&d);
  std::sort(sorted.begin(), sorted.end(),
            [](const Detection* a, const Detection* b) { return corner_key(*a) < corner_key(*b); });
  return sorted;
}

bool have_same_serials(const Rig& a, const Rig& b) {
  return std::equal(a.cameras.begin(), a.cameras.end(), b.cameras.begin(), b.cameras.end(),
                    [](const RigCamera& one, const RigCamera& other) {
                      return !one.serial.empty() && one.serial == other.serial;
                    });
}

std::string fingerprint(const Rig& rig) {
  Fingerprint hash;
  for (const RigCamera& camera : rig.cameras) {
    const CameraParameters& p = camera.model.parameters();
    hash.add(to_string(p.distortion));
    for (const double value : {p.fu_px, p.fv_px, p.pu_px, p.pv_px}) hash.add(value);
    for (const double value : p.coefficients) hash.add(value);
    hash.add(std::int64_t{p.width_px});
    hash.add(std::int64_t{p.height_px});
    hash.add(camera.rig_from_cam.rotation.coeffs());
    hash.add(camera.rig_from_cam.translation);
  }
  return hash.hexadecimal();
}

bool are_same(const Rig& a, const Rig& b) {
  if (fingerprint(a) != fingerprint(b)) return false;
  return std::equal(
      a.cameras.begin(), a.cameras.end(), b.cameras.begin(), b.cameras.end(),
      [](const RigCamera& one, const RigCamera& other) {
        return one.name == other.name &&
               (one.serial.empty() || other.serial.empty() || one.serial == other.serial);
      });
}

std::string fingerprint(const DetectedCapture& capture) {
  Fingerprint hash;
  hash.add(fingerprint(capture.rig));
  for (const ImageDetections& image : capture.images) {
    hash.add(image.stamp.count());
    hash.add(std::int64_t{image.camera});
    for (const Detection* d : in_canonical_order(image.detections)) {
      hash.add(format_marker_id(d->marker, true));
      for (const Eigen::Vector2d& corner : d->corners) hash.add(corner);
    }
  }
  return hash.hexadecimal();
}

std::string fingerprint(const std::vector<std::string>& rigs) {
  Fingerprint hash;
  for (const std::string& rig : rigs) hash.add(rig);
  return hash.hexadecimal();
}

}  // namespace waymark
