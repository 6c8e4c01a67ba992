#include "mapbuilder/import/opencv_video.h"

#include <stdlib.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <system_error>
#include <utility>

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// FFmpeg's library writes what it meets to stderr, beside our one clear line; OpenCV lets it only
/// by this variable, read once. A user who wants to see it sets the variable to a level above 0.
void silence_ffmpeg() {
  ::setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", /*overwrite=*/0);  // NOLINT(concurrency-mt-unsafe)
}

/// One video and the frame that comes next from it.
class Video {
 public:
  static Expected<Video> open(int camera, const fs::path& path, const CameraParameters& expected,
                              int every) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) {
      return fail(ErrorKind::no_input, "{}: no such video file", path.string());
    }
    Video video;
    video.camera_ = camera;
    video.path_ = path;
    video.every_ = every;
    silence_ffmpeg();
    try {
      // Only FFmpeg's reader gives the container's stamps.
      video.capture_.open(path.string(), cv::CAP_FFMPEG);
      if (!video.capture_.isOpened()) {
        return fail(ErrorKind::bad_data, "{}: not a video that FFmpeg can decode", path.string());
      }
      // Turned frames would no longer fit the calibration.
      video.capture_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
    } catch (const cv::Exception& error) {
      return fail(ErrorKind::bad_data, "{}: can't open the video: {}", path.string(), error.err);
    }
    const int width = static_cast<int>(video.capture_.get(cv::CAP_PROP_FRAME_WIDTH));
    const int height = static_cast<int>(video.capture_.get(cv::CAP_PROP_FRAME_HEIGHT));
    if (width != expected.width_px || height != expected.height_px) {
      return fail(ErrorKind::bad_data,
                  "{}: the video is {}×{}, rig.yaml says {}×{}; frames are never scaled: calibrate "
                  "at this size",
                  path.string(), width, height, expected.width_px, expected.height_px);
    }
    if (auto status = video.advance(); !status) return tl::make_unexpected(status.error());
    if (!video.next_) {
      return fail(ErrorKind::bad_data, "{}: no frame can be decoded", path.string());
    }
    return video;
  }

  [[nodiscard]] const std::optional<VideoFrame>& peek() const { return next_; }

  /// Takes the next frame and reads the one behind it.
  Expected<VideoFrame> take() {
    VideoFrame frame = std::move(*next_);
    if (auto status = advance(); !status) return tl::make_unexpected(status.error());
    return frame;
  }

  [[nodiscard]] std::size_t expected_frames() const {
    const double frames = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    if (!(frames > 0 && frames < 1e9)) return 0;
    return (static_cast<std::size_t>(frames) + static_cast<std::size_t>(every_) - 1) /
           static_cast<std::size_t>(every_);
  }

  [[nodiscard]] std::optional<std::string> orientation_note() const {
    const double degrees = capture_.get(cv::CAP_PROP_ORIENTATION_META);
    if (degrees == 0) return std::nullopt;
    return fmt::format("{}: asks for a rotation by {}°; ignored, pixels are used as stored",
                       path_.string(), degrees);
  }

  /// Said once, at the end of a video that ends before it said it would.
  [[nodiscard]] std::optional<std::string> truncation_note() const {
    const double announced = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    // Containers count roughly; one lost in a hundred is rounding.
    if (next_ || !(announced > 0) || static_cast<double>(grabbed_) >= 0.99 * announced) {
      return std::nullopt;
    }
    return fmt::format("{}: ends after {} of {} frames; is the file cut off?", path_.string(),
                       grabbed_, announced);
  }

 private:
  /// Decodes the next frame that counts into `next_`.
  Status advance() {
    next_.reset();
    try {
      while (capture_.grab()) {
        const bool counts = grabbed_ % static_cast<std::size_t>(every_) == 0;
        const Stamp stamp = stamp_of_grabbed();
        if (last_stamp_ && stamp <= *last_stamp_) {
          return fail(ErrorKind::bad_data,
                      "{}: frame {}: the container's stamps don't rise ({} ns after {} ns); write "
                      "the video anew",
                      path_.string(), grabbed_, stamp.count(), last_stamp_->count());
        }
        last_stamp_ = stamp;
        ++grabbed_;
        if (!counts) continue;
        cv::Mat picture;
        if (!capture_.retrieve(picture) || picture.empty()) continue;
        next_ = VideoFrame{camera_, stamp, gray(picture)};
        return {};
      }
    } catch (const cv::Exception& error) {
      return fail(ErrorKind::bad_data, "{}: frame {}: can't decode: {}", path_.string(), grabbed_,
                  error.err);
    }
    return {};
  }

  /// The container's stamp. OpenCV loses it (and says 0) for the last frames of a video whose codec
  /// delays them, and for containers without stamps: then the frame rate counts on.
  [[nodiscard]] Stamp stamp_of_grabbed() const {
    const double container_ms = capture_.get(cv::CAP_PROP_POS_MSEC);
    if (container_ms > 0 || !last_stamp_) return Stamp(std::llround(container_ms * 1e6));
    const double rate_hz = capture_.get(cv::CAP_PROP_FPS);
    // Without a rate the stamp does not rise, which the caller reports.
    return *last_stamp_ + (rate_hz > 0 ? Stamp(std::llround(1e9 / rate_hz)) : Stamp::zero());
  }

  static GrayImage gray(const cv::Mat& picture) {
    GrayImage image(picture.cols, picture.rows);
    cv::Mat pixels(picture.rows, picture.cols, CV_8UC1, image.pixels.data());
    if (picture.channels() == 1) {
      picture.copyTo(pixels);
    } else {
      cv::cvtColor(picture, pixels, cv::COLOR_BGR2GRAY);
    }
    return image;
  }

  int camera_ = 0;
  fs::path path_;
  int every_ = 1;
  cv::VideoCapture capture_;
  std::size_t grabbed_ = 0;
  std::optional<Stamp> last_stamp_;  ///< of the last frame grabbed
  std::optional<VideoFrame> next_;
};

class OpenCvVideoSource : public VideoSource {
 public:
  static Expected<std::unique_ptr<VideoSource>> open(const std::vector<fs::path>& paths,
                                                     const Rig& rig, int every) {
    auto source = std::make_unique<OpenCvVideoSource>();
    for (std::size_t camera = 0; camera < paths.size(); ++camera) {
      auto video = Video::open(static_cast<int>(camera), paths[camera],
                               rig.cameras[camera].model.parameters(), every);
      if (!video) return tl::make_unexpected(video.error());
      if (auto note = video->orientation_note()) source->notes_.push_back(std::move(*note));
      source->videos_.push_back(std::move(*video));
    }
    return source;
  }

  Expected<std::optional<VideoFrame>> next() override {
    Video* earliest = nullptr;
    for (Video& video : videos_) {
      const bool earlier =
          video.peek() && (earliest == nullptr || video.peek()->stamp < earliest->peek()->stamp);
      if (earlier) earliest = &video;
    }
    if (earliest != nullptr) {
      auto frame = earliest->take();
      if (!frame) return tl::make_unexpected(frame.error());
      return std::optional<VideoFrame>(std::move(*frame));
    }
    if (!std::exchange(ended_, true)) {
      for (const Video& video : videos_) {
        if (auto note = video.truncation_note()) notes_.push_back(std::move(*note));
      }
    }
    return std::optional<VideoFrame>();
  }

  [[nodiscard]] std::size_t expected_frames() const override {
    std::size_t frames = 0;
    for (const Video& video : videos_) frames += video.expected_frames();
    return frames;
  }

  [[nodiscard]] const std::vector<std::string>& notes() const override { return notes_; }

 private:
  std::vector<Video> videos_;
  std::vector<std::string> notes_;
  bool ended_ = false;
};

}  // namespace
}  // namespace waymark

void waymark_open_videos(const std::vector<std::filesystem::path>& videos, const waymark::Rig& rig,
                         int every,
                         waymark::Expected<std::unique_ptr<waymark::VideoSource>>& result) {
  result = waymark::OpenCvVideoSource::open(videos, rig, every);
}
