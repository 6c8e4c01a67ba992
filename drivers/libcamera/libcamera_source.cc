#include "drivers/libcamera/libcamera_source.h"

#include <dlfcn.h>

#include "core/base/check.h"

namespace waymark {

namespace {

/// What the module calls `name`; null, with dlerror(), where it is not installed. Found beside the
/// program by its run path. It stays loaded: frames come from its code.
template <typename Function>
Function* of_module(const char* name) {
  void* const module = ::dlopen(kLibcameraModule, RTLD_NOW | RTLD_LOCAL);
  void* const symbol = module != nullptr ? ::dlsym(module, name) : nullptr;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): dlsym knows no types
  return reinterpret_cast<Function*>(symbol);
}

}  // namespace

bool is_libcamera_id(std::string_view device) {
  return !device.starts_with("/dev/") && !device.starts_with("serial=") &&
         !device.starts_with("bus=");
}

Expected<std::unique_ptr<FrameSource>> libcamera_source(std::shared_ptr<VideoSystem> system,
                                                        const LibcameraOptions& options) {
  WAYMARK_CHECK(options.camera.check().has_value());
  auto* const make = of_module<MakeLibcameraSource>(kMakeLibcameraSourceSymbol);
  if (make == nullptr) {
    return fail(ErrorKind::unavailable,
                "{}: driver \"libcamera\" can't be loaded: {}; install waymark-libcamera, or use "
                "\"v4l2\"",
                options.camera.name, ::dlerror());  // NOLINT(concurrency-mt-unsafe)
  }
  std::unique_ptr<FrameSource> source;
  make(std::move(system), options, source);
  return source;
}

std::vector<LibcameraCamera> libcamera_cameras(VideoSystem& system) {
  std::vector<LibcameraCamera> cameras;
  auto* const list = of_module<ListLibcameraCameras>(kListLibcameraCamerasSymbol);
  if (list != nullptr) list(system, cameras);
  return cameras;
}

}  // namespace waymark
