#include "mapbuilder/import/unpacked_source.h"

#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>

#include "core/base/check.h"

namespace waymark {
namespace {

/// What a decompressor is given and what is left of it.
class PackedBlock {
 public:
  explicit PackedBlock(ByteSource& packed) : packed_(packed), block_(kBlock) {}

  /// Reads on where all was used; false at the end.
  Expected<bool> fill() {
    if (!left_.empty()) return true;
    const auto got = packed_.read(block_);
    if (!got) return tl::make_unexpected(got.error());
    left_ = std::span<const std::uint8_t>(block_).first(*got);
    return *got > 0;
  }

  [[nodiscard]] std::span<const std::uint8_t> left() const { return left_; }
  void use(std::size_t count) { left_ = left_.subspan(count); }

 private:
  static constexpr std::size_t kBlock = std::size_t{1} << 16;

  ByteSource& packed_;
  std::vector<std::uint8_t> block_;
  std::span<const std::uint8_t> left_;
};

/// What one call of a decompressor did.
struct UnpackStep {
  std::size_t used = 0;
  std::size_t made = 0;
  bool frame_ended = false;
  const char* failure = nullptr;
};

/// The loop that both decompressors have: `Frames` makes one step.
template <typename Frames>
class UnpackedSource : public ByteSource {
 public:
  explicit UnpackedSource(ByteSource& packed) : block_(packed) {}

  Expected<std::size_t> read(std::span<std::uint8_t> buffer) override {
    std::size_t filled = 0;
    while (filled < buffer.size()) {
      const auto more = block_.fill();
      if (!more) return tl::make_unexpected(more.error());
      const UnpackStep step = frames_.unpack(block_.left(), buffer.subspan(filled));
      if (step.failure != nullptr) {
        return fail(ErrorKind::bad_data, "damaged compression ({}): {}", Frames::kName,
                    step.failure);
      }
      block_.use(step.used);
      filled += step.made;
      within_frame_ = step.used + step.made > 0 ? !step.frame_ended : within_frame_;
      if (*more || step.made > 0) continue;
      if (within_frame_)
        return fail(ErrorKind::bad_data, "truncated compression ({})", Frames::kName);
      break;
    }
    return filled;
  }

 private:
  PackedBlock block_;
  Frames frames_;
  bool within_frame_ = false;
};

class ZstdFrames {
 public:
  static constexpr const char* kName = "zstd";

  ZstdFrames() : context_(ZSTD_createDCtx()) {
    WAYMARK_CHECK(context_ != nullptr);
    ZSTD_DCtx_setParameter(context_.get(), ZSTD_d_windowLogMax, kMaxZstdWindowLog);
  }

  UnpackStep unpack(std::span<const std::uint8_t> packed, std::span<std::uint8_t> buffer) {
    ZSTD_inBuffer in{packed.data(), packed.size(), 0};
    ZSTD_outBuffer out{buffer.data(), buffer.size(), 0};
    const std::size_t left = ZSTD_decompressStream(context_.get(), &out, &in);
    if (ZSTD_isError(left) != 0) return {0, 0, false, ZSTD_getErrorName(left)};
    return {in.pos, out.pos, left == 0, nullptr};
  }

 private:
  struct Deleter {
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  };
  std::unique_ptr<ZSTD_DCtx, Deleter> context_;
};

class Lz4Frames {
 public:
  static constexpr const char* kName = "lz4";

  Lz4Frames() {
    LZ4F_dctx* context = nullptr;
    WAYMARK_CHECK(LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) == 0);
    context_.reset(context);
  }

  UnpackStep unpack(std::span<const std::uint8_t> packed, std::span<std::uint8_t> buffer) {
    std::size_t used = packed.size();
    std::size_t made = buffer.size();
    const std::size_t left =
        LZ4F_decompress(context_.get(), buffer.data(), &made, packed.data(), &used, nullptr);
    if (LZ4F_isError(left) != 0) return {0, 0, false, LZ4F_getErrorName(left)};
    return {used, made, left == 0, nullptr};
  }

 private:
  struct Deleter {
    void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
  };
  std::unique_ptr<LZ4F_dctx, Deleter> context_;
};

}  // namespace

Expected<std::size_t> SpanSource::read(std::span<std::uint8_t> buffer) {
  const std::size_t count = std::min(buffer.size(), bytes_.size());
  std::copy_n(bytes_.begin(), count, buffer.begin());
  bytes_ = bytes_.subspan(count);
  return count;
}

bool looks_like_zstd(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::uint8_t, 4> kMagic{0x28, 0xB5, 0x2F, 0xFD};
  return bytes.size() >= kMagic.size() && std::equal(kMagic.begin(), kMagic.end(), bytes.begin());
}

std::unique_ptr<ByteSource> unpacked_zstd(ByteSource& packed) {
  return std::make_unique<UnpackedSource<ZstdFrames>>(packed);
}

std::unique_ptr<ByteSource> unpacked_lz4(ByteSource& packed) {
  return std::make_unique<UnpackedSource<Lz4Frames>>(packed);
}

Expected<std::vector<std::uint8_t>> unpack_zstd(std::span<const std::uint8_t> packed,
                                                std::size_t max_bytes) {
  constexpr std::size_t kStep = std::size_t{1} << 20;
  SpanSource source(packed);
  const auto unpacked = unpacked_zstd(source);
  std::vector<std::uint8_t> bytes;
  for (;;) {
    const std::size_t before = bytes.size();
    bytes.resize(before + kStep);
    const auto got = unpacked->read(std::span(bytes).subspan(before));
    if (!got) return tl::make_unexpected(got.error());
    bytes.resize(before + *got);
    if (bytes.size() > max_bytes) {
      return fail(ErrorKind::bad_data, "it unpacks to more than {} bytes", max_bytes);
    }
    if (*got < kStep) return bytes;
  }
}

}  // namespace waymark
