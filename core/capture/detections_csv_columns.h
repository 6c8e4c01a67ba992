#pragma once

#include <array>
#include <string_view>

namespace waymark {

// What a detections.csv of ours consists of, for those who read and write it.

/// `# detector=NAME markers=FINGERPRINT`.
inline constexpr std::string_view kOwnLinePrefix = "# detector=";
inline constexpr std::string_view kFingerprintKey = " markers=";

inline constexpr std::array<std::string_view, 8> kCornerColumns{"x0", "y0", "x1", "y1",
                                                                "x2", "y2", "x3", "y3"};
inline constexpr std::array<std::string_view, 12> kCovarianceColumns{
    "sxx0", "sxy0", "syy0", "sxx1", "sxy1", "syy1", "sxx2", "sxy2", "syy2", "sxx3", "sxy3", "syy3"};

}  // namespace waymark
