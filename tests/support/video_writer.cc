#include "tests/support/video_writer.h"

#include <gtest/gtest.h>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include <algorithm>
#include <cstring>

namespace waymark::test {

struct VideoWriter::Implementation {
  Options options;
  AVFormatContext* container = nullptr;
  AVStream* stream = nullptr;
  AVCodecContext* encoder = nullptr;
  AVFrame* frame = av_frame_alloc();
  AVPacket* packet = av_packet_alloc();

  ~Implementation() {
    av_packet_free(&packet);
    av_frame_free(&frame);
    avcodec_free_context(&encoder);
    if (container != nullptr) {
      avio_closep(&container->pb);
      avformat_free_context(container);
    }
  }

  /// Luma of 0 to 255; else 16 to 235.
  [[nodiscard]] bool full_range() const { return options.codec == "mjpeg"; }

  void begin_encoder(int width, int height) {
    if (encoder != nullptr) drain(nullptr);
    avcodec_free_context(&encoder);
    const AVCodec* const codec = avcodec_find_encoder_by_name(options.codec.c_str());
    ASSERT_NE(codec, nullptr) << options.codec;
    encoder = avcodec_alloc_context3(codec);
    encoder->width = width;
    encoder->height = height;
    encoder->time_base = {1, options.rate_hz};
    encoder->framerate = {options.rate_hz, 1};
    encoder->max_b_frames = options.b_frames;
    encoder->gop_size = 6;
    encoder->color_range = full_range() ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
    encoder->pix_fmt = full_range() ? AV_PIX_FMT_YUVJ420P : AV_PIX_FMT_YUV420P;
    encoder->thread_count = 1;
    encoder->flags |= AV_CODEC_FLAG_QSCALE;
    encoder->global_quality = FF_QP2LAMBDA;
    encoder->qmin = 1;
    if ((container->oformat->flags & AVFMT_GLOBALHEADER) != 0) {
      encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    }
    ASSERT_GE(avcodec_open2(encoder, codec, nullptr), 0);
  }

  void begin_file() {
    stream = avformat_new_stream(container, nullptr);
    ASSERT_GE(avcodec_parameters_from_context(stream->codecpar, encoder), 0);
    stream->time_base = encoder->time_base;
    stream->avg_frame_rate = encoder->framerate;
    ASSERT_GE(avformat_write_header(container, nullptr), 0);
  }

  void drain(const AVFrame* picture) {
    ASSERT_GE(avcodec_send_frame(encoder, picture), 0);
    while (avcodec_receive_packet(encoder, packet) >= 0) {
      packet->duration = 1;
      av_packet_rescale_ts(packet, encoder->time_base, stream->time_base);
      packet->stream_index = stream->index;
      ASSERT_GE(av_interleaved_write_frame(container, packet), 0);
    }
  }
};

VideoWriter::VideoWriter(const std::filesystem::path& path, const Options& options)
    : implementation_(std::make_unique<Implementation>()) {
  av_log_set_level(AV_LOG_QUIET);
  Implementation& self = *implementation_;
  self.options = options;
  EXPECT_GE(avformat_alloc_output_context2(&self.container, nullptr, nullptr, path.c_str()), 0);
  EXPECT_GE(avio_open(&self.container->pb, path.c_str(), AVIO_FLAG_WRITE), 0);
}

VideoWriter::~VideoWriter() {
  if (implementation_->stream == nullptr) return;
  implementation_->drain(nullptr);
  EXPECT_GE(av_write_trailer(implementation_->container), 0);
}

void VideoWriter::write(const GrayView& picture, int number) {
  Implementation& self = *implementation_;
  const bool other_size = self.encoder == nullptr || self.encoder->width != picture.width_px ||
                          self.encoder->height != picture.height_px;
  if (other_size) self.begin_encoder(picture.width_px, picture.height_px);
  if (self.stream == nullptr) self.begin_file();
  ASSERT_NE(self.stream, nullptr);
  av_frame_unref(self.frame);
  self.frame->format = self.encoder->pix_fmt;
  self.frame->width = picture.width_px;
  self.frame->height = picture.height_px;
  self.frame->pts = number;
  self.frame->quality = FF_QP2LAMBDA;
  ASSERT_GE(av_frame_get_buffer(self.frame, 0), 0);
  for (int y = 0; y < picture.height_px; ++y) {
    std::transform(picture.row(y), picture.row(y) + picture.width_px,
                   self.frame->data[0] + y * self.frame->linesize[0], [&](std::uint8_t grey) {
                     return self.full_range() ? grey
                                              : static_cast<std::uint8_t>(16 + grey * 219 / 255);
                   });
  }
  for (const int plane : {1, 2}) {
    std::memset(self.frame->data[plane], 128,
                static_cast<std::size_t>(self.frame->linesize[plane]) *
                    static_cast<std::size_t>((picture.height_px + 1) / 2));
  }
  self.drain(self.frame);
}

}  // namespace waymark::test
