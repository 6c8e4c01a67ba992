extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/display.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <array>
#include <cmath>
#include <system_error>
#include <utility>

#include "core/base/is_there.h"
#include "core/capture/frame_set.h"
#include "mapbuilder/import/video_module.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// Videos. Play lists, which open other files and addresses, are none.
constexpr const char* kContainers =
    "asf,avi,flv,h264,hevc,ivf,matroska,webm,mjpeg,mov,mp4,m4a,3gp,3g2,mj2,mpeg,mpegts,nut,ogg,"
    "yuv4mpegpipe";

template <typename Thing, void (*free_thing)(Thing**)>
struct Free {
  void operator()(Thing* thing) const { free_thing(&thing); }
};
using Container = std::unique_ptr<AVFormatContext, Free<AVFormatContext, avformat_close_input>>;
using Codec = std::unique_ptr<AVCodecContext, Free<AVCodecContext, avcodec_free_context>>;
using Packet = std::unique_ptr<AVPacket, Free<AVPacket, av_packet_free>>;
using Picture = std::unique_ptr<AVFrame, Free<AVFrame, av_frame_free>>;

struct FreeScaler {
  void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};

std::string reason(int status) {
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(status, text.data(), text.size());
  return text.data();
}

/// Turns pictures of whatever kind into grey: the luma, black at 0 and white at 255.
class GrayConverter {
 public:
  GrayImage convert(const AVFrame& picture) {
    scaler_.reset(sws_getCachedContext(scaler_.release(), picture.width, picture.height,
                                       static_cast<AVPixelFormat>(picture.format), picture.width,
                                       picture.height, AV_PIX_FMT_GRAY8,
                                       SWS_BILINEAR | SWS_ACCURATE_RND, nullptr, nullptr, nullptr));
    GrayImage image(picture.width, picture.height);
    if (scaler_ == nullptr) return image;
    const int* const matrix = sws_getCoefficients(picture.colorspace);
    const int full_range = picture.color_range == AVCOL_RANGE_JPEG ? 1 : 0;
    sws_setColorspaceDetails(scaler_.get(), matrix, full_range, matrix, 1, 0, 1 << 16, 1 << 16);
    std::uint8_t* const rows[] = {image.pixels.data()};
    const int strides[] = {image.width_px};
    sws_scale(scaler_.get(), picture.data, picture.linesize, 0, picture.height, rows, strides);
    return image;
  }

 private:
  std::unique_ptr<SwsContext, FreeScaler> scaler_;
};

/// One video and the frame that comes next from it, decoded but not converted yet.
class Video {
 public:
  static Expected<Video> open(int camera, const fs::path& path, const CameraParameters& expected) {
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) {
      return absent(path, "no such video file");
    }
    Video video;
    video.camera_ = camera;
    video.path_ = path.string();
    if (auto status = video.open_container(); !status) return tl::make_unexpected(status.error());
    const AVCodecParameters& stated = *video.stream_->codecpar;
    if (stated.width != expected.width_px || stated.height != expected.height_px) {
      return fail(ErrorKind::bad_data,
                  "{}: the video is {}×{}, rig.yaml says {}×{}; frames are never scaled: calibrate "
                  "at this size",
                  video.path_, stated.width, stated.height, expected.width_px, expected.height_px);
    }
    if (auto status = video.open_codec(); !status) return tl::make_unexpected(status.error());
    if (auto status = video.advance(); !status) return tl::make_unexpected(status.error());
    if (!video.stamp_) return fail(ErrorKind::bad_data, "{}: no frame can be decoded", video.path_);
    return video;
  }

  /// Of the next frame; nullopt at the end.
  [[nodiscard]] std::optional<Stamp> stamp() const { return stamp_; }

  /// The next frame, which is there.
  VideoFrame frame() { return {camera_, *stamp_, gray_.convert(*picture_)}; }

  /// Goes on to the frame behind it.
  Status advance() {
    const std::optional<Stamp> last = std::exchange(stamp_, std::nullopt);
    for (;;) {
      const auto decoded = decode();
      if (!decoded) return tl::make_unexpected(decoded.error());
      if (!*decoded) return {};
      ++decoded_;
      if (picture_->decode_error_flags != 0 || (picture_->flags & AV_FRAME_FLAG_CORRUPT) != 0) {
        ++damaged_;
        continue;
      }
      return take_stamp(last);
    }
  }

  /// By the container; 0: it does not say.
  [[nodiscard]] double rate_hz() const {
    const AVRational rate = stream_->avg_frame_rate;
    return rate.num > 0 && rate.den > 0 ? av_q2d(rate) : 0.0;
  }

  /// As the container announces it; 0: it does not say.
  [[nodiscard]] std::size_t announced_frames() const {
    if (stream_->nb_frames > 0) return static_cast<std::size_t>(stream_->nb_frames);
    const double seconds = static_cast<double>(container_->duration) / AV_TIME_BASE;
    const double frames = seconds * rate_hz();
    return frames > 0 && frames < 1e9 ? static_cast<std::size_t>(std::lround(frames)) : 0;
  }

  [[nodiscard]] std::optional<std::string> orientation_note() const {
    const std::uint8_t* const matrix =
        av_stream_get_side_data(stream_, AV_PKT_DATA_DISPLAYMATRIX, nullptr);
    if (matrix == nullptr) return std::nullopt;
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): nine numbers, as documented
    const double degrees = -av_display_rotation_get(reinterpret_cast<const std::int32_t*>(matrix));
    if (!(std::abs(degrees) > 0)) return std::nullopt;
    return fmt::format("{}: asks for a rotation by {:.0f}°; ignored, pixels are used as stored",
                       path_, degrees);
  }

  /// Complete at the end.
  [[nodiscard]] std::vector<std::string> damage_notes() const {
    std::vector<std::string> notes;
    if (damaged_ > 0) {
      notes.push_back(fmt::format("{}: {} frames are damaged: left out", path_, damaged_));
    }
    const auto announced = static_cast<double>(announced_frames());
    // Containers count roughly; one lost in a hundred is rounding.
    if (!stamp_ && static_cast<double>(decoded_) < 0.99 * announced) {
      notes.push_back(fmt::format("{}: ends after {} of {:.0f} frames; is the file cut off?", path_,
                                  decoded_, announced));
    }
    return notes;
  }

 private:
  Status open_container() {
    AVFormatContext* opened = nullptr;
    AVDictionary* options = nullptr;
    av_dict_set(&options, "protocol_whitelist", "file", 0);
    av_dict_set(&options, "format_whitelist", kContainers, 0);
    int status = avformat_open_input(&opened, path_.c_str(), nullptr, &options);
    av_dict_free(&options);
    container_.reset(opened);
    if (status >= 0) status = avformat_find_stream_info(container_.get(), nullptr);
    int found = -1;
    if (status >= 0) {
      found = av_find_best_stream(container_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    }
    if (status < 0 || found < 0) {
      return fail(ErrorKind::bad_data, "{}: not a video that FFmpeg can decode: {}", path_,
                  reason(std::min(status, found)));
    }
    stream_ = container_->streams[found];
    for (unsigned i = 0; i < container_->nb_streams; ++i) {
      if (container_->streams[i] != stream_) container_->streams[i]->discard = AVDISCARD_ALL;
    }
    return {};
  }

  Status open_codec() {
    const AVCodec* const decoder = avcodec_find_decoder(stream_->codecpar->codec_id);
    codec_.reset(decoder != nullptr ? avcodec_alloc_context3(decoder) : nullptr);
    int status = AVERROR_DECODER_NOT_FOUND;
    if (codec_ != nullptr) {
      avcodec_parameters_to_context(codec_.get(), stream_->codecpar);
      codec_->thread_count = 0;  // as many as there are processors
      // A stream may claim other sizes than its container.
      constexpr std::int64_t kAnyCamera = std::int64_t{1} << 24;
      const std::int64_t pixels = std::int64_t{codec_->width} * codec_->height;
      codec_->max_pixels = std::max(4 * pixels, kAnyCamera);
      status = avcodec_open2(codec_.get(), decoder, nullptr);
    }
    if (status < 0) {
      return fail(ErrorKind::bad_data, "{}: can't decode the video: {}", path_, reason(status));
    }
    packet_.reset(av_packet_alloc());
    picture_.reset(av_frame_alloc());
    return {};
  }

  /// The next picture that the decoder yields; false at the end. What can't be decoded is counted.
  Expected<bool> decode() {
    for (;;) {
      const int received = avcodec_receive_frame(codec_.get(), picture_.get());
      if (received >= 0) return true;
      if (received == AVERROR_EOF) return false;
      if (received != AVERROR(EAGAIN)) {
        ++damaged_;
        continue;
      }
      if (!feed()) return false;
    }
  }

  /// Gives the decoder the next packet of the stream, or at its end the word to yield what it holds
  /// back. False when it has had that already.
  bool feed() {
    if (drained_) return false;
    while (av_read_frame(container_.get(), packet_.get()) >= 0) {
      const bool ours = packet_->stream_index == stream_->index;
      const bool bad = ours && avcodec_send_packet(codec_.get(), packet_.get()) < 0;
      av_packet_unref(packet_.get());
      if (bad) ++damaged_;
      if (ours && !bad) return true;
    }
    drained_ = true;
    return avcodec_send_packet(codec_.get(), nullptr) >= 0;
  }

  /// Of the picture just decoded, which must be of the size that the video began with.
  Status take_stamp(std::optional<Stamp> last) {
    const AVCodecParameters& stated = *stream_->codecpar;
    if (picture_->width != stated.width || picture_->height != stated.height) {
      return fail(ErrorKind::bad_data,
                  "{}: frame {}: the picture is {}×{} from here on, {}×{} before; split the video "
                  "there",
                  path_, decoded_ - 1, picture_->width, picture_->height, stated.width,
                  stated.height);
    }
    const Stamp stamp = container_stamp(last);
    if (!is_in_range(stamp) || (last && stamp <= *last)) {
      return fail(Cause::stamps,
                  "{}: frame {}: the container's stamps don't rise ({} ns after {} ns); write the "
                  "video anew",
                  path_, decoded_ - 1, stamp.count(), last.value_or(Stamp{0}).count());
    }
    stamp_ = stamp;
    return {};
  }

  /// Where a container has no stamps, its rate counts on.
  [[nodiscard]] Stamp container_stamp(std::optional<Stamp> last) const {
    constexpr AVRational kNanoseconds{1, 1'000'000'000};
    const std::int64_t ticks = picture_->best_effort_timestamp;
    if (ticks != AV_NOPTS_VALUE) {
      return Stamp(av_rescale_q(ticks, stream_->time_base, kNanoseconds));
    }
    if (!last) return Stamp{0};
    // Without a rate the stamp does not rise, which is said.
    return *last + (rate_hz() > 0 ? Stamp(std::llround(1e9 / rate_hz())) : Stamp{0});
  }

  int camera_ = 0;
  std::string path_;
  Container container_;
  AVStream* stream_ = nullptr;  ///< the container's
  Codec codec_;
  Packet packet_;
  Picture picture_;
  GrayConverter gray_;
  std::optional<Stamp> stamp_;
  std::size_t decoded_ = 0;
  std::size_t damaged_ = 0;
  bool drained_ = false;
};

/// Frames of several videos by their stamps, in turns: of each video at most one within half a
/// frame's time. Of all turns every so many counts, for all videos alike, so that a frame that one
/// of them lost shifts nothing.
class LibavVideoSource : public VideoSource {
 public:
  static Expected<std::unique_ptr<VideoSource>> open(const std::vector<fs::path>& paths,
                                                     const Rig& rig, int every) {
    av_log_set_level(AV_LOG_QUIET);  // it would write to stderr beside our one clear line
    auto source = std::make_unique<LibavVideoSource>();
    source->every_ = static_cast<std::size_t>(every);
    for (std::size_t camera = 0; camera < paths.size(); ++camera) {
      auto video = Video::open(static_cast<int>(camera), paths[camera],
                               rig.cameras[camera].model.parameters());
      if (!video) return tl::make_unexpected(video.error());
      if (auto note = video->orientation_note()) source->notes_.push_back(std::move(*note));
      if (video->rate_hz() > 0) {
        const Stamp half_a_frame(std::llround(0.5e9 / video->rate_hz()));
        source->turn_lasts_ = std::min(source->turn_lasts_.value_or(half_a_frame), half_a_frame);
      }
      source->videos_.push_back(std::move(*video));
    }
    source->had_a_frame_.resize(paths.size());
    return source;
  }

  Expected<std::optional<VideoFrame>> next() override {
    while (const auto earliest = earliest_video()) {
      Video& video = videos_[*earliest];
      std::optional<VideoFrame> frame;
      if (belongs_to_a_turn_that_counts(*earliest, *video.stamp())) frame = video.frame();
      if (auto status = video.advance(); !status) return tl::make_unexpected(status.error());
      if (frame) return frame;
    }
    if (!std::exchange(ended_, true)) {
      for (const Video& video : videos_) {
        for (std::string& note : video.damage_notes()) notes_.push_back(std::move(note));
      }
    }
    return std::optional<VideoFrame>();
  }

  [[nodiscard]] std::size_t expected_frames() const override {
    std::size_t frames = 0;
    for (const Video& video : videos_) frames += (video.announced_frames() + every_ - 1) / every_;
    return frames;
  }

  [[nodiscard]] const std::vector<std::string>& notes() const override { return notes_; }

 private:
  [[nodiscard]] std::optional<std::size_t> earliest_video() const {
    std::optional<std::size_t> earliest;
    for (std::size_t i = 0; i < videos_.size(); ++i) {
      if (!videos_[i].stamp()) continue;
      if (!earliest || *videos_[i].stamp() < *videos_[*earliest].stamp()) earliest = i;
    }
    return earliest;
  }

  bool belongs_to_a_turn_that_counts(std::size_t video, Stamp stamp) {
    const Stamp lasts = turn_lasts_.value_or(kDefaultSyncTolerance);
    if (turns_ == 0 || had_a_frame_[video] || time_between(turn_began_, stamp) > lasts) {
      ++turns_;
      turn_began_ = stamp;
      had_a_frame_.assign(had_a_frame_.size(), false);
    }
    had_a_frame_[video] = true;
    return (turns_ - 1) % every_ == 0;
  }

  std::vector<Video> videos_;
  std::size_t every_ = 1;
  std::optional<Stamp> turn_lasts_;
  std::size_t turns_ = 0;
  Stamp turn_began_{0};
  std::vector<bool> had_a_frame_;
  std::vector<std::string> notes_;
  bool ended_ = false;
};

}  // namespace
}  // namespace waymark

void waymark_open_videos(const std::vector<std::filesystem::path>& videos, const waymark::Rig& rig,
                         int every,
                         waymark::Expected<std::unique_ptr<waymark::VideoSource>>& result) {
  result = waymark::LibavVideoSource::open(videos, rig, every);
}
