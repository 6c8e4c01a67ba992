#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/capture/gray_image.h"

namespace waymark::test {

/// Writes a video of grey pictures; the file's ending chooses the container. Failures fail the
/// test.
class VideoWriter {
 public:
  struct Options {
    std::string codec = "mjpeg";
    int rate_hz = 25;
    int b_frames = 0;  ///< held back by codecs that know such
  };
  VideoWriter(const std::filesystem::path& path, const Options& options);
  explicit VideoWriter(const std::filesystem::path& path) : VideoWriter(path, Options{}) {}
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;
  ~VideoWriter();

  /// As frame `number` of the rate's count; numbers rise, and what is left out is a lost frame. A
  /// picture of another size than the one before begins a new encoder in the same stream.
  void write(const GrayView& picture, int number);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace waymark::test
