#include "drivers/frame_maker.h"

#include <algorithm>

#include "core/base/check.h"

namespace waymark {
namespace {

constexpr std::size_t kDriverBuffers = 2;  ///< never lent
/// A larger step of a device's count is a new count (1e3–1e9).
constexpr std::uint32_t kWildStep = 1'000'000;

}  // namespace

std::size_t FrameLayout::least_bytes() const {
  if (pixels->kind == PixelFormat::Kind::jpeg) return 1;
  return stride_bytes * static_cast<std::size_t>(height_px - 1) +
         static_cast<std::size_t>(width_px) * static_cast<std::size_t>(pixels->bytes_per_pixel);
}

void FrameMaker::begin(const FrameLayout& layout, std::shared_ptr<const void> memory,
                       std::size_t buffers) {
  WAYMARK_CHECK(buffers >= kFewestBuffers);
  end();
  layout_ = layout;
  const std::size_t lendable = buffers - kDriverBuffers;
  if (in_place()) {
    lender_.begin(std::move(memory), lendable);
    return;
  }
  images_ = std::make_shared<std::vector<GrayImage>>(lendable,
                                                     GrayImage(layout.width_px, layout.height_px));
  free_images_.resize(lendable);
  for (std::uint32_t i = 0; i < lendable; ++i) free_images_[i] = i;
  lender_.begin(images_, lendable, true);
}

void FrameMaker::end() {
  lender_.end();
  images_.reset();
  free_images_.clear();
  sequence_.reset();
}

bool FrameMaker::in_place() const { return layout_.pixels->kind == PixelFormat::Kind::luma_first; }

std::uint64_t FrameMaker::count(std::uint32_t device_sequence) {
  if (sequence_) {
    // Devices count in 32 bits; drivers that don't count repeat themselves.
    const auto step = std::max<std::uint32_t>(1, device_sequence - device_sequence_);
    if (step < kWildStep) lost_ += step - 1;
    *sequence_ += step < kWildStep ? step : 1;
  } else {
    sequence_ = device_sequence;
  }
  device_sequence_ = device_sequence;
  return *sequence_;
}

FrameMaker::Made FrameMaker::make(std::uint32_t buffer, std::span<const std::uint8_t> bytes,
                                  const FrameInfo& info) {
  if (bytes.size() < layout_.least_bytes()) {
    ++damaged_;
    return {};
  }
  if (!in_place()) return convert(bytes, info);
  const auto slot = lender_.lend(buffer);
  if (!slot) {
    ++lost_;
    return {std::nullopt, true, true};
  }
  const GrayView view{bytes.data(), layout_.width_px, layout_.height_px, layout_.stride_bytes};
  return {Frame(info, view, nullptr, &lender_, *slot), true, false};
}

FrameMaker::Made FrameMaker::convert(std::span<const std::uint8_t> bytes, const FrameInfo& info) {
  if (free_images_.empty()) {
    ++lost_;
    return {std::nullopt, true, true};
  }
  const std::uint32_t index = free_images_.back();
  GrayImage& image = (*images_)[index];
  if (!convert_to_gray(*layout_.pixels, bytes, layout_.stride_bytes, image)) {
    ++damaged_;
    return {};
  }
  const auto slot = lender_.lend(index);
  WAYMARK_CHECK(slot.has_value());  // there are as many images as may be lent
  free_images_.pop_back();
  return {Frame(info, image.view(), nullptr, &lender_, *slot), true, true};
}

std::optional<std::uint32_t> FrameMaker::take_returned() {
  while (const auto index = lender_.take_returned()) {
    if (in_place()) return index;
    free_images_.push_back(*index);
  }
  return std::nullopt;
}

}  // namespace waymark
