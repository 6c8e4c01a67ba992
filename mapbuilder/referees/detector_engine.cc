#include "mapbuilder/referees/detector_engine.h"

#include <dlfcn.h>

#include "mapbuilder/referees/referee_module.h"

namespace waymark {
namespace {

bool is_apriltags(Family family) {
  return family >= Family::tag16h5 && family != Family::aruco_mip_36h12;
}

/// Found beside the program by its run path. It stays loaded: detectors are made of its code.
Expected<MakeRefereeFunction*> load_referees() {
  void* const module = ::dlopen(kRefereeModule, RTLD_NOW | RTLD_LOCAL);
  void* const symbol = module != nullptr ? ::dlsym(module, kMakeRefereeSymbol) : nullptr;
  if (symbol == nullptr) {
    return fail(ErrorKind::unavailable,
                "{}: can't load OpenCV's and libapriltag's detectors: {}; install waymark-referees",
                kRefereeModule, ::dlerror());  // NOLINT(concurrency-mt-unsafe)
  }
  return reinterpret_cast<MakeRefereeFunction*>(symbol);  // NOLINT: dlsym knows no types
}

}  // namespace

std::string_view name_of(DetectorEngine engine) {
  switch (engine) {
    case DetectorEngine::own:
      return "own";
    case DetectorEngine::opencv:
      return "opencv";
    case DetectorEngine::apriltag:
      break;
  }
  return "apriltag";
}

bool engine_knows(DetectorEngine engine, Family family, bool inverted) {
  switch (engine) {
    case DetectorEngine::own:
      return true;
    case DetectorEngine::opencv:
      return !marker_layout(family).is_light() && !inverted;
    case DetectorEngine::apriltag:
      break;
  }
  return is_apriltags(family) && !inverted;
}

Expected<std::unique_ptr<MarkerDetector>> make_detector(DetectorEngine engine,
                                                        const MarkerCatalog& catalog,
                                                        const std::string& name,
                                                        double min_side_px) {
  DetectorOptions options{min_side_px};
  std::vector<Family> families;
  for (const auto& entry : catalog.entries()) {
    families.push_back(entry.family);
    if (entry.inverted) options.inverted.push_back(entry.family);
    if (engine_knows(engine, entry.family, entry.inverted)) continue;
    return fail(ErrorKind::usage, "{}: --detector {} does not know {}{}; own does", name,
                name_of(engine), name_of(entry.family), entry.inverted ? " inverted" : "");
  }
  if (engine == DetectorEngine::own) return make_detector(families, options);
  const auto make = load_referees();
  if (!make) return tl::make_unexpected(make.error());
  std::unique_ptr<MarkerDetector> referee;
  (*make)(engine, families, min_side_px, referee);
  return referee;
}

}  // namespace waymark
