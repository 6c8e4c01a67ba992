#include "mapbuilder/observations/detected_capture.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "core/base/fingerprint.h"

namespace waymark {
namespace {

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

std::vector<EdgeMove> edge_moves(const DetectedCapture& capture) {
  std::vector<EdgeMove> moves;
  for (std::size_t c = 0; c < capture.rig.cameras.size(); ++c) {
    EdgeMove& move = moves.emplace_back();
    if (c < capture.edges.size()) move.measured = capture.edges[c];
    move.px =
        move.measured ? move.measured->bias_px : capture.rig.cameras[c].edge_bias_px.value_or(0);
  }
  return moves;
}

bool have_same_serials(const Rig& a, const Rig& b) {
  return std::equal(a.cameras.begin(), a.cameras.end(), b.cameras.begin(), b.cameras.end(),
                    [](const RigCamera& one, const RigCamera& other) {
                      return !one.serial.empty() && one.serial == other.serial;
                    });
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
      for (const Eigen::Vector2d& corner : d->corners) hash.add(std::span(corner.data(), 2));
    }
  }
  return hash.hexadecimal();
}

std::string fingerprint(std::span<const Rig> rigs) {
  std::set<std::string> different;
  for (const Rig& rig : rigs) different.insert(fingerprint(rig));
  if (different.size() == 1) return *different.begin();
  Fingerprint hash;
  for (const std::string& one : different) hash.add(one);
  return hash.hexadecimal();
}

}  // namespace waymark
