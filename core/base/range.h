#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace waymark {

/// The numbers that an option may have, both ends among them; NaN is in no range. Stated once,
/// where the option is: its library, the configuration and the command line ask it.
struct Range {
  double low = 0;
  double high = 0;

  [[nodiscard]] constexpr bool contains(double value) const {
    return value >= low && value <= high;
  }
};

/// Holds the fields of an options struct against their ranges.
class RangeCheck {
 public:
  RangeCheck& field(std::string_view name, double value, const Range& range);
  /// The check of options within these: its error, with their name before the field's.
  RangeCheck& part(std::string_view name, const Status& checked);
  /// usage, naming the first field that is outside.
  [[nodiscard]] Status status() const;

 private:
  std::optional<Error> first_error_;
};

/// A command line's check of an option (CLI11): what is wrong with its text, empty when nothing is.
[[nodiscard]] std::function<std::string(const std::string&)> number_in(Range range);

}  // namespace waymark
