#include "core/capture/jpeg_segments.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/capture/exif.h"

namespace waymark {
namespace {

constexpr std::string_view kExifPrefix("Exif\0\0", 6);
constexpr std::string_view kJfifPrefix("JFIF\0", 5);
constexpr std::string_view kAdobePrefix("Adobe", 5);
constexpr std::size_t kAdobeTransform = 11;  ///< where it stands in the segment's content

enum Marker : std::uint8_t {
  kTem = 0x01,
  kProgressive = 0xC2,
  kRestart0 = 0xD0,
  kStart = 0xD8,
  kEnd = 0xD9,
  kScan = 0xDA,
  kApp0 = 0xE0,
  kApp1 = 0xE1,
  kApp14 = 0xEE,
};

/// Of both entropy codings, with and without differences between frames.
bool is_progressive(std::uint8_t marker) { return (marker & 0xF3U) == kProgressive; }

bool stands_alone(std::uint8_t marker) {
  return marker == kTem || (marker >= kRestart0 && marker <= kRestart0 + 7);
}

class Walker {
 public:
  Walker(std::string_view bytes, int scan_limit) : bytes_(bytes), scan_limit_(scan_limit) {}

  JpegSegments walk() {
    at_ = 2;  // behind the start marker
    while (segments_.scans <= scan_limit_) {
      const auto marker = next_marker();
      if (!marker || *marker == kStart || *marker == kEnd) break;
      if (!stands_alone(*marker) && !take_segment(*marker)) break;
    }
    tidy();
    return std::move(segments_);
  }

 private:
  struct Range {
    std::size_t begin;
    std::size_t end;
  };

  [[nodiscard]] std::uint8_t byte(std::size_t at) const {
    return static_cast<std::uint8_t>(bytes_[at]);
  }

  /// Passes over whatever is no marker: a scan's pixels, or bytes that belong nowhere.
  std::optional<std::uint8_t> next_marker() {
    const std::size_t begin = at_;
    for (;;) {
      at_ = bytes_.find('\xFF', at_);
      if (at_ == std::string_view::npos) return std::nullopt;
      const std::size_t first_fill = at_;
      at_ = bytes_.find_first_not_of('\xFF', at_);
      if (at_ == std::string_view::npos) return std::nullopt;
      const std::uint8_t marker = byte(at_++);
      if (marker == 0) continue;  // a pixel's 0xFF
      if (segments_.scans == 0 && first_fill > begin) strays_.push_back({begin, first_fill});
      return marker;
    }
  }

  /// False where the bytes end before it does.
  bool take_segment(std::uint8_t marker) {
    if (bytes_.size() - at_ < 2) return false;
    const std::size_t length = byte(at_) * std::size_t{256} + byte(at_ + 1);
    if (length < 2 || bytes_.size() - at_ < length) return false;
    const std::size_t begin = at_ + 2;
    const std::string_view content = bytes_.substr(begin, length - 2);
    at_ += length;
    if (marker == kScan) ++segments_.scans;
    if (is_progressive(marker)) segments_.progressive = true;
    if (marker == kApp1 && content.starts_with(kExifPrefix) && !exif_seen_) {
      exif_seen_ = true;
      // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes of a block
      const auto* const block = reinterpret_cast<const std::uint8_t*>(content.data());
      segments_.orientation =
          exif_orientation(std::span(block, content.size()).subspan(kExifPrefix.size()));
    }
    // Readers take an unknown version for the first one, and say so.
    if (marker == kApp0 && content.starts_with(kJfifPrefix) && content.size() > 5) {
      if (content[5] != 1) become_one_.push_back(begin + 5);
    }
    if (marker == kApp14 && content.starts_with(kAdobePrefix) && content.size() > kAdobeTransform) {
      const auto transform = static_cast<std::uint8_t>(content[kAdobeTransform]);
      if (transform > 1) become_one_.push_back(begin + kAdobeTransform);
    }
    return true;
  }

  void tidy() {
    if (strays_.empty() && become_one_.empty()) return;
    std::string whole(bytes_);
    for (const std::size_t at : become_one_) whole[at] = 1;
    std::size_t kept = 0;
    for (const Range& stray : strays_) {
      segments_.tidied.append(whole, kept, stray.begin - kept);
      kept = stray.end;
    }
    segments_.tidied.append(whole, kept);
  }

  std::string_view bytes_;
  int scan_limit_;
  std::size_t at_ = 0;
  JpegSegments segments_;
  bool exif_seen_ = false;
  std::vector<Range> strays_;
  std::vector<std::size_t> become_one_;
};

}  // namespace

JpegSegments walk_jpeg(std::string_view bytes, int scan_limit) {
  return Walker(bytes, scan_limit).walk();
}

}  // namespace waymark
