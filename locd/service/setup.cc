#include "locd/service/setup.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numbers>

#include "core/base/atomic_file.h"
#include "core/base/notes.h"
#include "core/camera/kalibr.h"
#include "core/camera/rig_parameters.h"
#include "core/capture/sync_tolerance.h"
#include "core/map/map_file.h"
#include "core/marker/marker_catalog.h"
#include "locd/frames/realtime.h"
#include "locd/pose/map_index.h"
#include "locd/publish/lcm_url.h"
#include "locd/service/map_rig_notes.h"

namespace waymark {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;

/// Brings the configuration's cameras into the rig's order.
Status match_cameras(Setup& setup) {
  const std::string rig_file = setup.config.rig.camchain.string();
  std::vector<Config::Camera> by_rig;
  for (RigCamera& camera : setup.rig.cameras) {
    const auto& configured = setup.config.cameras;
    const auto found = std::find_if(configured.begin(), configured.end(),
                                    [&](const auto& c) { return c.name == camera.name; });
    if (found == configured.end()) {
      return fail(ErrorKind::config, "{}: {} has no [[camera]] block in locd.toml; add one",
                  rig_file, camera.name);
    }
    if (found->readout_us) camera.readout_us = found->readout_us;
    by_rig.push_back(*found);
  }
  for (const Config::Camera& camera : setup.config.cameras) {
    const auto in_rig = [&](const auto& c) { return c.name == camera.name; };
    if (std::none_of(by_rig.begin(), by_rig.end(), in_rig)) {
      return fail(ErrorKind::config, "[[camera]] {} is not in {}; its cameras are cam0 to cam{}",
                  camera.name, rig_file, setup.rig.cameras.size() - 1);
    }
  }
  setup.config.cameras = std::move(by_rig);
  return {};
}

/// What frames that come as often as the configuration says can be paired by.
void fit_sync_tolerance(Setup& setup) {
  double fps = 0;
  for (const Config::Camera& camera : setup.config.cameras) fps = std::max(fps, camera.fps);
  if (fps <= 0) return;
  const auto usable = usable_tolerance(from_us(setup.config.sync.tolerance_us), from_us(1e6 / fps),
                                       setup.config.cameras.size());
  if (!usable.note) return;
  setup.config.sync.tolerance_us = in_us(usable.tolerance);
  setup.notes.push_back("[sync] tolerance_us: " + *usable.note);
}

Status check_rig(const Setup& setup) {
  const std::string name = setup.config.rig.camchain.string();
  const std::size_t cameras = setup.rig.cameras.size();
  if (cameras > kMaxCameras) {
    return fail(ErrorKind::config, "{}: {} cameras; locd takes at most {}", name, cameras,
                kMaxCameras);
  }
  if (cameras > 1 && !setup.rig.has_extrinsics) {
    return fail(ErrorKind::config, "{}: {} cameras without transforms between them; add T_cn_cnm1",
                name, cameras);
  }
  if (static_cast<std::size_t>(setup.config.sync.min_cameras) > cameras) {
    return fail(ErrorKind::config, "[sync] min_cameras = {}, but the rig has {}",
                setup.config.sync.min_cameras, cameras);
  }
  return {};
}

/// The catalog of what the map holds, each marker with its stated size.
MarkerCatalog catalog_of(const MarkerMap& map) {
  std::map<Family, MarkerCatalog::FamilyEntry> by_family;
  for (const SubMap& submap : map.submaps) {
    for (const MapMarker& marker : submap.markers) {
      MarkerCatalog::FamilyEntry& entry = by_family[marker.id.family];
      entry.family = marker.id.family;
      entry.size_m_by_id[marker.id.number] = marker.stated_size_m;
    }
  }
  std::vector<MarkerCatalog::FamilyEntry> entries;
  for (auto& [family, entry] : by_family) entries.push_back(std::move(entry));
  return MarkerCatalog(std::move(entries));
}

/// What a recording's markers.toml says: the configured file, else that of a replayed capture, else
/// the markers of the map.
Status find_markers(Setup& setup) {
  const Config& config = setup.config;
  std::filesystem::path file = config.record.markers;
  const Config::Camera& camera = config.cameras.front();
  if (file.empty() && camera.driver == CameraDriver::replay) {
    file = std::filesystem::path(camera.device) / "markers.toml";
  }
  if (file.empty()) {
    if (setup.map) setup.markers_toml = format_marker_catalog(catalog_of(*setup.map));
    return {};
  }
  const auto catalog = read_marker_catalog(file);
  if (!catalog) return tl::make_unexpected(catalog.error());
  setup.markers_toml = format_marker_catalog(*catalog);
  setup.inverted = inverted_families(*catalog);
  return {};
}

Status read_map(Setup& setup) {
  const std::filesystem::path& path = setup.config.map;
  if (path.empty()) {
    setup.notes.emplace_back("no [map]: recording only, every pose is LOST");
    return {};
  }
  auto map = read_map_file(path);
  if (!map) return tl::make_unexpected(map.error());
  setup.map_hash = content_hash(*map);
  setup.map = std::move(*map);
  return {};
}

void note_map_and_rig(Setup& setup) {
  const std::filesystem::path& camchain = setup.config.rig.camchain;
  if (setup.map) {
    MapRigNotes told = map_rig_notes(*setup.map, setup.config.map, setup.rig, camchain);
    setup.warnings = std::move(told.warnings);
    std::move(told.notes.begin(), told.notes.end(), std::back_inserter(setup.notes));
  } else if (auto note = note_of_default_sigmas(setup.rig, camchain.string())) {
    setup.notes.push_back(*std::move(note));
  }
}

Status read_key(Setup& setup) {
  const std::filesystem::path& file = setup.config.lcm.key_file;
  if (file.empty()) return {};
  auto key = MessageKey::read(file);
  if (!key) return tl::make_unexpected(key.error());
  setup.key = *key;
  return {};
}

void note_who_hears(Setup& setup) {
  const LcmUrl url = *parse_lcm_url(setup.config.lcm.url);
  if (!url.group) {
    setup.notes.emplace_back("[lcm] url is memq://: nobody hears poses outside this process");
  } else if (url.ttl > 0) {
    setup.notes.push_back(
        fmt::format("[lcm] url has ttl={}: messages leave this machine, and everybody in its "
                    "network reads them",
                    url.ttl));
  }
}

}  // namespace

Expected<Setup> load_setup(const std::filesystem::path& path) {
  auto config = read_config(path);
  if (!config) return tl::make_unexpected(config.error());
  Setup setup;
  setup.config = std::move(*config);
  auto rig = read_camchain(setup.config.rig.camchain);
  if (!rig) return tl::make_unexpected(rig.error());
  setup.rig = std::move(rig->rig);
  for (Status (*step)(Setup&) : {match_cameras, read_map, find_markers, read_key}) {
    if (auto done = step(setup); !done) return tl::make_unexpected(done.error());
  }
  if (auto checked = check_rig(setup); !checked) return tl::make_unexpected(checked.error());
  fit_sync_tolerance(setup);
  note_who_hears(setup);
  if (setup.markers_toml.empty()) {
    setup.notes.emplace_back(
        "no [record] markers: recordings need a markers.toml before mapbuilder reads them");
  }
  note_map_and_rig(setup);
  // The rig's come last: of very many only the first are shown.
  std::move(rig->notes.begin(), rig->notes.end(), std::back_inserter(setup.notes));
  return setup;
}

std::vector<std::string> told_of(const Setup& setup) {
  std::vector<std::string> lines;
  for (const std::string& warning : shown_notes(setup.warnings)) {
    lines.push_back("warning: " + warning);
  }
  for (const std::string& note : shown_notes(setup.notes)) lines.push_back(note);
  return lines;
}

bool same_rig(const Rig& a, const Rig& b) { return format_camchain(a) == format_camchain(b); }

LocalizerOptions localizer_options(const Setup& setup) {
  const Config& config = setup.config;
  LocalizerOptions options;
  options.inverted = setup.inverted;
  options.triggered = config.sync.triggered;
  options.doubt_first_images = true;
  options.prior_max_age_s = config.solve.prior_max_age_s;
  options.online_calibration = config.calibration.online;
  options.gate.max_3sigma_m = config.solve.ok_sigma_m;
  options.gate.max_3sigma_rad = config.solve.ok_sigma_deg * kRadiansPerDegree;
  options.gate.max_protection_m = config.solve.ok_protection_m;
  options.gate.max_protection_rad = config.solve.ok_protection_deg * kRadiansPerDegree;
  options.protected_point_in_rig = config.rig.base_from_rig.inverse().translation;
  options.gate.v_max_mps = config.solve.v_max_mps;
  options.gate.w_max_radps = config.solve.w_max_dps * kRadiansPerDegree;
  const bool realtime = config.service.realtime;
  options.begin_worker = [realtime] {
    name_thread("detection");
    // The start of the program has found out whether it may.
    if (realtime) static_cast<void>(make_realtime(kLocalizationPriority));
  };
  return options;
}

SyncOptions sync_options(const Config& config) {
  SyncOptions options;
  options.tolerance = from_us(config.sync.tolerance_us);
  options.deadline = from_us(config.sync.deadline_ms * 1e3);
  options.min_cameras = config.sync.min_cameras;
  return options;
}

std::vector<Stamp> stamp_delays(const Config& config) {
  std::vector<Stamp> delays;
  for (const Config::Camera& camera : config.cameras) {
    delays.push_back(from_us(camera.stamp_delay_us));
  }
  return delays;
}

}  // namespace waymark
