#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/capture/capture_folder.h"
#include "drivers/frame_source.h"

namespace waymark {

/// How a capture is played.
struct ReplayOptions {
  bool realtime = false;   ///< at its own pace from start on, with stamps moved to CLOCK_MONOTONIC;
                           ///< else as fast as it is asked, with its own stamps
  bool loop = false;       ///< from the start again, one median period after the end, for 146 years
  bool images = true;      ///< images are read; else only detections.csv is played
  bool detections = true;  ///< detections.csv is played, where it is there
};

/// A capture folder as cameras: one source per camera of its rig, all on one time line.
/// Deterministic: the same folder gives the same frames with the same numbers, whatever the pace
/// (stamps moved by one constant, where they are moved).
class ReplayCapture {
 public:
  /// Errors: those of open_capture_folder and read_detections_csv; bad_data when what shall be
  /// played is not there, or when names are no stamps.
  [[nodiscard]] static Expected<std::shared_ptr<ReplayCapture>> open(
      const std::filesystem::path& folder, const ReplayOptions& options);

  [[nodiscard]] const CaptureFolder& folder() const { return folder_; }
  [[nodiscard]] const ReplayOptions& options() const { return options_; }

  /// Stamps, in the first round, lie this much after those in the folder. 0 unless realtime; set by
  /// the first source that starts.
  [[nodiscard]] Stamp shift() const { return shift_.load(); }

  /// Images that could not be used, of all cameras, and why the first could not.
  struct Unusable {
    std::size_t images = 0;
    std::string first_reason;
  };
  [[nodiscard]] Unusable unusable() const;

  /// One source per camera, by the rig's order. Each holds the capture.
  [[nodiscard]] static std::vector<std::unique_ptr<FrameSource>> sources(
      const std::shared_ptr<ReplayCapture>& capture);

 private:
  friend class ReplaySource;
  /// One frame to come: a file, or what was found, or both.
  struct Entry {
    Stamp stamp{0};
    const ImageFile* image = nullptr;
    const ImageDetections* detections = nullptr;
  };

  ReplayCapture() = default;
  [[nodiscard]] Status fill_time_line();
  /// Fixes the shift, once, so that the first frame comes now.
  void begin_time_line();
  void note_unusable(const Error& why);
  /// Rounds whose stamps all lie in range.
  [[nodiscard]] std::size_t most_rounds() const;

  CaptureFolder folder_;
  ReplayOptions options_;
  std::vector<ImageDetections> detections_;
  std::vector<std::vector<Entry>> entries_;  ///< per camera, by rising stamp
  Stamp first_{0};
  Stamp round_{0};  ///< from one round's first frame to the next round's
  std::once_flag begun_;
  std::atomic<Stamp> shift_{Stamp{0}};
  mutable std::mutex mutex_;  ///< of what follows
  Unusable unusable_;
};

}  // namespace waymark
