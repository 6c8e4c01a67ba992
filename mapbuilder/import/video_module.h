#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/base/error.h"
#include "core/camera/rig.h"
#include "mapbuilder/import/video_source.h"

namespace waymark {

/// What the module that decodes videos gives: `result` becomes the source of `videos`, one per
/// camera of the rig, or why it can't be opened.
using OpenVideosFunction = void(const std::vector<std::filesystem::path>& videos, const Rig& rig,
                                int every, Expected<std::unique_ptr<VideoSource>>& result);

/// The module's file and the name of its function.
inline constexpr const char* kVideoModule = "libwaymark_video.so";
inline constexpr const char* kOpenVideosSymbol = "waymark_open_videos";

}  // namespace waymark

extern "C" waymark::OpenVideosFunction waymark_open_videos;
