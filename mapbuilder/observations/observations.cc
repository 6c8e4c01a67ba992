#include "mapbuilder/observations/observations.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/base/parallel.h"
#include "core/camera/rig_parameters.h"
#include "core/estimate/consider_parameters.h"
#include "core/estimate/ippe.h"

namespace waymark {
namespace {

/// Of two captures by one camera: the mean by their weights, no surer than the less sure; nullopt
/// where one has not measured.
std::optional<EdgeMeasurement> common_edges(const std::optional<EdgeMeasurement>& a,
                                            const std::optional<EdgeMeasurement>& b) {
  if (!a || !b) return std::nullopt;
  const double weight_a = 1 / (a->sigma_px * a->sigma_px);
  const double weight_b = 1 / (b->sigma_px * b->sigma_px);
  EdgeMeasurement both;
  both.bias_px = (weight_a * a->bias_px + weight_b * b->bias_px) / (weight_a + weight_b);
  both.sigma_px = std::max(a->sigma_px, b->sigma_px);
  if (a->response == b->response) both.response = a->response;
  return both;
}

/// Gives each capture's images their frame sets, rigs and observations.
class ObservationMaker {
 public:
  ObservationMaker(const ObservationOptions& options, const std::map<MarkerId, StatedSize>& sizes)
      : options_(options) {
    for (const auto& [marker, size] : sizes) {
      index_of_.emplace(marker, made_.markers.push_back(marker));
      made_.stated_sizes_m.push_back(size.size_m);
      made_.size_sigmas.push_back(size.sigma);
    }
  }

  void add(const DetectedCapture& capture, std::size_t place, const std::string& hash) {
    const CaptureIndex index =
        made_.captures.push_back({capture.name, hash, place, capture.monotonic});
    std::vector<StampedImage> stamped;
    stamped.reserve(capture.images.size());
    for (const ImageDetections& image : capture.images) {
      stamped.push_back({image.camera, image.stamp});
    }
    const bool mono = options_.mono || capture.rig.cameras.size() == 1;
    const std::vector<RigIndex> rigs = rigs_of(capture, mono);
    take_edges(capture, rigs);
    const auto frame_sets = mono ? one_frame_set_per_image(stamped)
                                 : group_into_frame_sets(stamped, capture.sync_tolerance);
    for (const FrameSet& frame_set : frame_sets) {
      const int camera = mono ? stamped[frame_set.images.front()].camera : 0;
      ObservedFrameSet set;
      set.rig = rigs[static_cast<std::size_t>(camera)];
      set.capture = index;
      set.stamp = frame_set.stamp;
      // A rig of one camera needs no "camN" in its trajectory's name unless mono was asked for.
      if (options_.mono) set.mono_camera = camera;
      const FrameSetIndex made = made_.frame_sets.push_back(set);
      for (const std::size_t image : frame_set.images) {
        add_image(capture.images[image], mono ? 0 : capture.images[image].camera, made);
      }
    }
  }

  /// Leaves out what lies beyond its camera's calibration or has no IPPE solution, and puts what an
  /// image shows twice behind the rest.
  [[nodiscard]] Observations finish(int threads) && {
    const std::vector<View> views = views_of_found(threads);
    made_.beyond_calibration.assign(made_.cameras.size(), 0);
    std::vector<Observation> repeated;
    std::size_t at = 0;
    for (const FrameSetIndex f : made_.frame_sets.indices()) {
      const std::size_t first = made_.all.size();
      for (; at < found_.size() && found_[at].observation.frame_set == f; ++at) {
        const Observation& o = found_[at].observation;
        if (views[at] == View::beyond_calibration) {
          ++made_.beyond_calibration[o.camera];
        } else if (found_[at].repeated) {
          if (views[at] == View::square) repeated.push_back(o);
        } else if (views[at] == View::square) {
          made_.all.push_back(o);
        } else {
          ++made_.degenerate;
        }
      }
      made_.frame_sets[f].observations = {first, made_.all.size() - first};
    }
    made_.usable = made_.all.size();
    for (const Observation& o : repeated) made_.all.push_back(o);
    return std::move(made_);
  }

 private:
  struct Found {
    Observation observation;
    bool repeated = false;
  };

  /// Per camera of a mono capture, else one.
  std::vector<RigIndex> rigs_of(const DetectedCapture& capture, bool mono) {
    if (!mono) return {index_of(capture.rig)};
    std::vector<RigIndex> rigs;
    for (std::size_t c = 0; c < capture.rig.cameras.size(); ++c) {
      rigs.push_back(index_of(single_camera_rig(capture.rig, c)));
    }
    return rigs;
  }

  void take_edges(const DetectedCapture& capture, const std::vector<RigIndex>& rigs) {
    auto& edges = made_.edges;
    for (std::size_t c = 0; c < capture.rig.cameras.size(); ++c) {
      const bool alone = rigs.size() > 1;
      const CameraIndex camera(made_.first_camera[rigs[alone ? c : 0]].value() + (alone ? 0 : c));
      const auto measured = c < capture.edges.size() ? capture.edges[c] : std::nullopt;
      if (camera.value() == edges.size()) {
        edges.push_back(measured);
      } else {
        edges[camera] = common_edges(edges[camera], measured);
      }
    }
  }

  /// Of the rig among those made; it is put there unless it is there already.
  RigIndex index_of(const Rig& rig) {
    for (const RigIndex r : made_.rigs.indices()) {
      if (are_same(rig, made_.rigs[r])) return r;
    }
    const RigIndex added = made_.rigs.push_back(rig);
    made_.first_camera.push_back(CameraIndex(made_.cameras.size()));
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) made_.cameras.push_back({added, c});
    return added;
  }

  void add_image(const ImageDetections& image, int camera_in_rig, FrameSetIndex frame_set) {
    std::vector<const Detection*> sorted = in_canonical_order(image.detections);
    std::erase_if(sorted, [&](const Detection* d) { return !index_of_.contains(d->marker); });
    const CameraIndex first = made_.first_camera[made_.frame_sets[frame_set].rig];
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      const Detection& d = *sorted[i];
      Found found;
      found.repeated = (i > 0 && sorted[i - 1]->marker == d.marker) ||
                       (i + 1 < sorted.size() && sorted[i + 1]->marker == d.marker);
      found.observation.frame_set = frame_set;
      found.observation.camera =
          CameraIndex(first.value() + static_cast<std::size_t>(camera_in_rig));
      found.observation.marker = index_of_.at(d.marker);
      found.observation.corners_px = d.corners;
      found.observation.covariances = d.covariances.value_or(
          CornerCovariances{Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero(),
                            Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero()});
      made_.repeated_in_image += found.repeated ? 1 : 0;
      found_.push_back(found);
    }
  }

  /// Of what an observation's corners are a view.
  enum class View : char { square, none, beyond_calibration };
  [[nodiscard]] std::vector<View> views_of_found(int threads) const {
    std::vector<View> views(found_.size(), View::beyond_calibration);
    parallel_for(found_.size(), threads, [&](std::size_t i) {
      const Observation& o = found_[i].observation;
      const CameraPlace& place = made_.cameras[o.camera];
      const CameraModel& camera = made_.rigs[place.rig].cameras[place.in_rig].model;
      if (!camera.covers_all(o.corners_px)) return;
      const auto pose = solve_ippe(camera, o.corners_px, made_.stated_sizes_m[o.marker]);
      views[i] = pose ? View::square : View::none;
    });
    return views;
  }

  ObservationOptions options_;
  Observations made_;
  std::map<MarkerId, MarkerIndex> index_of_;
  std::vector<Found> found_;  ///< by rising frame set
};

/// Sizes of all detected markers that exist; an id with two sizes is an error. Of two sigmas the
/// smaller holds: somebody has measured better.
Expected<std::map<MarkerId, StatedSize>> collect_sizes(
    const std::vector<DetectedCapture>& captures) {
  std::map<MarkerId, StatedSize> sizes;
  std::map<MarkerId, std::string> stated_by;
  for (const DetectedCapture& capture : captures) {
    for (const ImageDetections& image : capture.images) {
      for (const Detection& d : image.detections) {
        const auto size = capture.catalog.size_m(d.marker);
        if (!size) continue;
        const double sigma = *capture.catalog.size_sigma_m(d.marker) / *size;
        const auto [known, is_new] = sizes.emplace(d.marker, StatedSize{*size, sigma});
        if (is_new) {
          stated_by[d.marker] = capture.name;
        } else if (known->second.size_m == *size) {
          known->second.sigma = std::min(known->second.sigma, sigma);
        } else {
          return fail(ErrorKind::bad_data,
                      "{}: marker {} is {} m here and {} m in {}; make markers.toml of the "
                      "captures agree",
                      capture.name, format_marker_id(d.marker, true), *size, known->second.size_m,
                      stated_by[d.marker]);
        }
      }
    }
  }
  return sizes;
}

/// Error: bad_data when a rig has several cameras, no transforms, and is not used mono.
Status check_rigs(const std::vector<DetectedCapture>& captures, bool mono) {
  for (const DetectedCapture& capture : captures) {
    if (!mono && !capture.rig.has_extrinsics && capture.rig.cameras.size() > 1) {
      return fail(ErrorKind::bad_data,
                  "{}: rig.yaml has {} cameras without transforms between them; add T_cn_cnm1, or "
                  "map with --mono",
                  capture.name, capture.rig.cameras.size());
    }
  }
  return {};
}

/// By markers.toml; where captures differ, the name that sorts first: their order leaves no trace.
IndexedVector<MarkerIndex, std::string> groups_of(
    const std::vector<DetectedCapture>& captures,
    const IndexedVector<MarkerIndex, MarkerId>& markers) {
  IndexedVector<MarkerIndex, std::string> groups;
  for (const MarkerId& marker : markers.values()) {
    std::string first;
    for (const DetectedCapture& capture : captures) {
      std::string group = capture.catalog.group(marker);
      if (!group.empty() && (first.empty() || group < first)) first = std::move(group);
    }
    groups.push_back(std::move(first));
  }
  return groups;
}

std::string fingerprint_of_rigs(const std::vector<DetectedCapture>& captures) {
  std::vector<Rig> rigs;
  for (const DetectedCapture& capture : captures) rigs.push_back(capture.rig);
  return fingerprint(rigs);
}

/// See Observations::recalibrated.
std::vector<std::pair<std::string, std::string>> recalibrated_pairs(
    const std::vector<DetectedCapture>& captures) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const DetectedCapture& one : captures) {
    for (const DetectedCapture& other : captures) {
      if (other.name > one.name && !are_same(one.rig, other.rig) &&
          have_same_serials(one.rig, other.rig)) {
        pairs.emplace_back(one.name, other.name);
      }
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

Expected<Observations> make_observations(const std::vector<DetectedCapture>& captures,
                                         const ObservationOptions& options) {
  if (captures.empty()) return fail(ErrorKind::usage, "no capture given: name at least one");
  if (auto usable = check_rigs(captures, options.mono); !usable) {
    return tl::make_unexpected(usable.error());
  }
  const auto sizes = collect_sizes(captures);
  if (!sizes) return tl::make_unexpected(sizes.error());

  std::vector<std::pair<std::string, std::size_t>> order;
  for (std::size_t i = 0; i < captures.size(); ++i) {
    order.emplace_back(fingerprint(captures[i]), i);
  }
  std::sort(order.begin(), order.end());
  ObservationMaker maker(options, *sizes);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const auto& [hash, place] = order[i];
    if (i > 0 && order[i - 1].first == hash) {
      return fail(ErrorKind::usage, "{} and {} hold the same capture; name it once",
                  captures[order[i - 1].second].name, captures[place].name);
    }
    maker.add(captures[place], place, hash);
  }
  Observations made = std::move(maker).finish(effective_threads(options.threads));
  made.rig_fingerprint = fingerprint_of_rigs(captures);
  made.recalibrated = recalibrated_pairs(captures);
  made.groups = groups_of(captures, made.markers);
  return made;
}

}  // namespace waymark
