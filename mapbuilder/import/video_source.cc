#include "mapbuilder/import/video_source.h"

#include <dlfcn.h>

#include "mapbuilder/import/video_module.h"

namespace waymark {
namespace {

/// Found beside the program by its run path. It stays loaded: frames come from its code.
Expected<OpenVideosFunction*> load_decoder() {
  void* const module = ::dlopen(kVideoModule, RTLD_NOW | RTLD_LOCAL);
  void* const symbol = module != nullptr ? ::dlsym(module, kOpenVideosSymbol) : nullptr;
  if (symbol == nullptr) {
    return fail(ErrorKind::unavailable,
                "{}: can't load the video decoder: {}; install waymark-video", kVideoModule,
                ::dlerror());  // NOLINT(concurrency-mt-unsafe)
  }
  return reinterpret_cast<OpenVideosFunction*>(symbol);  // NOLINT: dlsym knows no types
}

}  // namespace

Status VideoOptions::check() const { return RangeCheck().field("--every", every, kEvery).status(); }

Expected<std::unique_ptr<VideoSource>> open_videos(const std::vector<std::filesystem::path>& videos,
                                                   const Rig& rig, const VideoOptions& options) {
  if (auto fine = options.check(); !fine) return tl::make_unexpected(fine.error());
  if (videos.size() != rig.cameras.size()) {
    return fail(ErrorKind::usage,
                "{} videos, but the rig has {} cameras; give one video per camera", videos.size(),
                rig.cameras.size());
  }
  if (videos.size() > 1 && !options.synchronized) {
    return fail(ErrorKind::usage,
                "{} videos: give --sync if their stamps count from one instant; otherwise they "
                "can't be one capture",
                videos.size());
  }
  const auto open = load_decoder();
  if (!open) return tl::make_unexpected(open.error());
  Expected<std::unique_ptr<VideoSource>> source;
  (*open)(videos, rig, options.every, source);
  return source;
}

}  // namespace waymark
