#include "drivers/libcamera/libcamera_source.h"

#include <dlfcn.h>

namespace waymark {

bool is_libcamera_id(std::string_view device) {
  return !device.starts_with("/dev/") && !device.starts_with("serial=") &&
         !device.starts_with("bus=");
}

Expected<std::unique_ptr<FrameSource>> libcamera_source(std::shared_ptr<VideoSystem> system,
                                                        const LibcameraOptions& options) {
  // Found beside the program by its run path. It stays loaded: frames come from its code.
  void* const module = ::dlopen(kLibcameraModule, RTLD_NOW | RTLD_LOCAL);
  void* const symbol = module != nullptr ? ::dlsym(module, kMakeLibcameraSourceSymbol) : nullptr;
  if (symbol == nullptr) {
    return fail(ErrorKind::unavailable,
                "{}: driver \"libcamera\" can't be loaded: {}; install waymark-libcamera, or use "
                "\"v4l2\"",
                options.camera.name, ::dlerror());  // NOLINT(concurrency-mt-unsafe)
  }
  std::unique_ptr<FrameSource> source;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): dlsym knows no types
  reinterpret_cast<MakeLibcameraSource*>(symbol)(std::move(system), options, source);
  return source;
}

}  // namespace waymark
