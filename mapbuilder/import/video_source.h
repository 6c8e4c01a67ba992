#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/base/range.h"
#include "core/camera/rig.h"
#include "core/capture/gray_image.h"
#include "core/geometry/stamp.h"

namespace waymark {

/// How videos are read.
struct VideoOptions {
  int every = 1;              ///< one of so many frames of each video is taken; the first always
  bool synchronized = false;  ///< several videos: their stamps count from one instant (--sync)

  static constexpr Range kEvery{1, 1'000'000};
  /// usage, naming the field that lies outside its range.
  [[nodiscard]] Status check() const;
};

/// One frame of a video.
struct VideoFrame {
  int camera = 0;   ///< index in the rig
  Stamp stamp{0};   ///< of the container, since the video's beginning
  GrayImage image;  ///< Rec. 601 luma; a rotation that the container asks for is ignored
};

/// Frames of one video per camera, one at a time, by rising (stamp, camera); one frame per video
/// is held, no more. Not for use from several threads.
class VideoSource {
 public:
  virtual ~VideoSource() = default;

  /// The next frame; nullopt at the end. bad_data when a video's stamps don't rise.
  [[nodiscard]] virtual Expected<std::optional<VideoFrame>> next() = 0;

  /// How many frames next() will yield as the containers announce it; 0 = unknown.
  [[nodiscard]] virtual std::size_t expected_frames() const = 0;

  /// What the user should know, one line each; complete after the last frame.
  [[nodiscard]] virtual const std::vector<std::string>& notes() const = 0;
};

/// Opens `videos`, in the order of the rig's cameras. Errors: usage (several videos without
/// `synchronized`; not as many as the rig has cameras; options out of range), no_input (absent),
/// bad_data (not a video that can be decoded; frames of another size than rig.yaml states),
/// unavailable (the module that decodes videos can't be loaded).
///
/// The decoder is a module of its own that is loaded here and not before: its libraries cost
/// 70 MB and 0.1–0.3 s, which only runs on videos should pay.
[[nodiscard]] Expected<std::unique_ptr<VideoSource>> open_videos(
    const std::vector<std::filesystem::path>& videos, const Rig& rig, const VideoOptions& options);

}  // namespace waymark
