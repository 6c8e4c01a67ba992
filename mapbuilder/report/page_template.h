#pragma once

#include <span>
#include <string_view>

namespace waymark {

/// The report page as build time made it of page/, in pieces: what stands before the data block's
/// content and what stands after it.
[[nodiscard]] std::span<const std::string_view> page_before_data();
[[nodiscard]] std::span<const std::string_view> page_after_data();

}  // namespace waymark
