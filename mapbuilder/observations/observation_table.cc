#include "mapbuilder/observations/observation_table.h"

#include <xxhash.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "core/base/parallel.h"

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

/// A rig that is the camera itself: mono frames are world_from_cam.
Rig single_camera_rig(const RigCamera& camera) {
  Rig rig;
  rig.cameras.push_back(camera);
  rig.cameras.front().rig_from_cam = Rigid3{};
  return rig;
}

/// Whether both rigs state all their cameras' serials, and these are alike.
bool have_same_serials(const Rig& a, const Rig& b) {
  return std::equal(a.cameras.begin(), a.cameras.end(), b.cameras.begin(), b.cameras.end(),
                    [](const RigCamera& one, const RigCamera& other) {
                      return !one.serial.empty() && one.serial == other.serial;
                    });
}

/// Gives each capture's images their frame sets, rigs and observations.
class TableMaker {
 public:
  explicit TableMaker(const TableOptions& options) : options_(options) {}

  void add(const DetectedCapture& capture, int capture_index) {
    std::vector<StampedImage> stamped;
    stamped.reserve(capture.images.size());
    for (const ImageDetections& image : capture.images) {
      stamped.push_back({image.camera, image.stamp});
    }
    const bool mono = options_.mono || capture.rig.cameras.size() == 1;
    std::vector<int> rigs;  // per camera of a mono capture, else one
    if (mono) {
      for (const RigCamera& camera : capture.rig.cameras) {
        rigs.push_back(number_of(single_camera_rig(camera)));
      }
    } else {
      rigs.push_back(number_of(capture.rig));
    }
    const auto frame_sets = mono ? one_frame_set_per_image(stamped)
                                 : group_into_frame_sets(stamped, capture.sync_tolerance);
    for (const FrameSet& frame_set : frame_sets) {
      const int camera = mono ? stamped[frame_set.images.front()].camera : -1;
      // A rig of one camera needs no "camN" in its trajectory's name unless mono was asked for.
      table.frame_sets.push_back({rigs[static_cast<std::size_t>(std::max(0, camera))],
                                  capture_index, frame_set.stamp, options_.mono ? camera : -1,
                                  table.observations.size(), 0});
      for (const std::size_t image : frame_set.images) {
        add_image(capture.images[image], mono ? 0 : capture.images[image].camera);
      }
      table.frame_sets.back().observation_count =
          table.observations.size() - table.frame_sets.back().first_observation;
    }
  }

  ObservationTable table;
  std::map<MarkerId, int> marker_index;

 private:
  /// Of the rig in the table; it is put there unless it is there already.
  int number_of(const Rig& rig) {
    const auto known = std::find_if(table.rigs.begin(), table.rigs.end(),
                                    [&](const Rig& other) { return are_same(rig, other); });
    if (known != table.rigs.end()) return static_cast<int>(known - table.rigs.begin());
    table.rigs.push_back(rig);
    return static_cast<int>(table.rigs.size()) - 1;
  }

  void add_image(const ImageDetections& image, int camera_in_rig) {
    std::vector<const Detection*> sorted;
    for (const Detection& d : image.detections) {
      if (marker_index.contains(d.marker)) sorted.push_back(&d);
    }
    std::sort(sorted.begin(), sorted.end(), [](const Detection* a, const Detection* b) {
      return corner_key(*a) < corner_key(*b);
    });
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      const Detection& d = *sorted[i];
      const bool repeated = (i > 0 && sorted[i - 1]->marker == d.marker) ||
                            (i + 1 < sorted.size() && sorted[i + 1]->marker == d.marker);
      TableObservation o;
      o.camera = camera_in_rig;
      o.corners_px = d.corners;
      o.frame_set = static_cast<int>(table.frame_sets.size()) - 1;
      o.marker = marker_index.at(d.marker);
      o.size_m = table.sizes_m[static_cast<std::size_t>(o.marker)];
      o.covariances = d.covariances.value_or(
          CornerCovariances{Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero(),
                            Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero()});
      o.whitening.fill(Eigen::Matrix2d::Identity());
      table.repeated_in_image += repeated ? 1 : 0;
      (repeated ? table.repeated : table.observations).push_back(o);
    }
  }

  TableOptions options_;
};

/// Sizes of all detected markers that exist; an id with two sizes is an error.
Expected<std::map<MarkerId, double>> collect_sizes(const std::vector<DetectedCapture>& captures) {
  std::map<MarkerId, double> sizes;
  std::map<MarkerId, std::string> stated_by;
  for (const DetectedCapture& capture : captures) {
    for (const ImageDetections& image : capture.images) {
      for (const Detection& d : image.detections) {
        const auto size = capture.catalog.size_m(d.marker);
        if (!size) continue;
        const auto [known, is_new] = sizes.emplace(d.marker, *size);
        if (is_new) {
          stated_by[d.marker] = capture.name;
        } else if (known->second != *size) {
          return fail(ErrorKind::bad_data,
                      "{}: marker {} is {} m here and {} m in {}; make markers.toml of the "
                      "captures agree",
                      capture.name, format_marker_id(d.marker, true), *size, known->second,
                      stated_by[d.marker]);
        }
      }
    }
  }
  return sizes;
}

/// Both IPPE solutions of every observation; those without any are taken out.
void solve_all_ippe(ObservationTable& table, int threads) {
  const auto solve = [&](TableObservation& o) {
    const TableFrameSet& set = table.frame_sets[static_cast<std::size_t>(o.frame_set)];
    const Rig& rig = table.rigs[static_cast<std::size_t>(set.rig)];
    o.ippe =
        solve_ippe(rig.cameras[static_cast<std::size_t>(o.camera)].model, o.corners_px, o.size_m);
  };
  parallel_for(table.observations.size(), threads,
               [&](std::size_t i) { solve(table.observations[i]); });
  for (TableObservation& o : table.repeated) solve(o);
  std::erase_if(table.repeated, [](const TableObservation& o) { return !o.ippe; });
  std::vector<TableObservation> kept;
  kept.reserve(table.observations.size());
  for (TableFrameSet& set : table.frame_sets) {
    const std::size_t first = kept.size();
    for (std::size_t i = 0; i < set.observation_count; ++i) {
      const TableObservation& o = table.observations[set.first_observation + i];
      if (o.ippe) {
        kept.push_back(o);
      } else {
        ++table.degenerate;
      }
    }
    set.first_observation = first;
    set.observation_count = kept.size() - first;
  }
  table.observations = std::move(kept);
}

}  // namespace

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
    std::vector<const Detection*> sorted;
    for (const Detection& d : image.detections) sorted.push_back(&d);
    std::sort(sorted.begin(), sorted.end(), [](const Detection* a, const Detection* b) {
      return corner_key(*a) < corner_key(*b);
    });
    for (const Detection* d : sorted) {
      hash.add(format_marker_id(d->marker, true));
      for (const Eigen::Vector2d& corner : d->corners) hash.add(corner);
    }
  }
  return hash.hexadecimal();
}

bool ObservationTable::several_families() const {
  return !markers.empty() && markers.front().family != markers.back().family;
}

Expected<ObservationTable> make_observation_table(std::vector<DetectedCapture> captures,
                                                  const TableOptions& options) {
  if (captures.empty()) return fail(ErrorKind::usage, "no capture given: name at least one");
  for (const DetectedCapture& capture : captures) {
    if (!options.mono && !capture.rig.has_extrinsics && capture.rig.cameras.size() > 1) {
      return fail(ErrorKind::bad_data,
                  "{}: rig.yaml has {} cameras without transforms between them; add T_cn_cnm1, or "
                  "map with --mono",
                  capture.name, capture.rig.cameras.size());
    }
  }
  auto sizes = collect_sizes(captures);
  if (!sizes) return tl::make_unexpected(sizes.error());

  std::vector<std::pair<std::string, std::size_t>> order;
  for (std::size_t i = 0; i < captures.size(); ++i) {
    order.emplace_back(fingerprint(captures[i]), i);
  }
  std::sort(order.begin(), order.end());

  std::set<std::string> rigs;
  for (const DetectedCapture& capture : captures) rigs.insert(fingerprint(capture.rig));
  Fingerprint all_rigs;
  for (const std::string& rig : rigs) all_rigs.add(rig);

  TableMaker maker(options);
  maker.table.rig_fingerprint = rigs.size() == 1 ? *rigs.begin() : all_rigs.hexadecimal();
  for (const auto& [marker, size] : *sizes) {
    maker.marker_index.emplace(marker, static_cast<int>(maker.table.markers.size()));
    maker.table.markers.push_back(marker);
    maker.table.stated_sizes_m.push_back(size);
    maker.table.sizes_m.push_back(size);
  }
  for (const auto& [hash, index] : order) {
    if (!maker.table.capture_fingerprints.empty() &&
        maker.table.capture_fingerprints.back() == hash) {
      return fail(ErrorKind::usage, "{} and {} hold the same capture; name it once",
                  maker.table.capture_names.back(), captures[index].name);
    }
    for (const DetectedCapture& other : captures) {
      if (other.name > captures[index].name && !are_same(captures[index].rig, other.rig) &&
          have_same_serials(captures[index].rig, other.rig)) {
        maker.table.recalibrated.emplace_back(captures[index].name, other.name);
      }
    }
    maker.table.capture_names.push_back(captures[index].name);
    maker.table.capture_places.push_back(index);
    maker.table.capture_monotonic.push_back(captures[index].monotonic ? 1 : 0);
    maker.table.capture_fingerprints.push_back(hash);
    maker.add(captures[index], static_cast<int>(maker.table.capture_names.size()) - 1);
  }
  ObservationTable table = std::move(maker.table);
  std::sort(table.recalibrated.begin(), table.recalibrated.end());
  for (const Rig& rig : table.rigs) {
    table.edge_bias_px.resize(table.edge_bias_px.size() + rig.cameras.size(), 0.0);
  }
  solve_all_ippe(table, effective_threads(options.threads));
  table.observations_of_marker.resize(table.markers.size());
  for (std::size_t i = 0; i < table.observations.size(); ++i) {
    table.observations_of_marker[static_cast<std::size_t>(table.observations[i].marker)].push_back(
        i);
  }
  return table;
}

}  // namespace waymark
