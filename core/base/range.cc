#include "core/base/range.h"

#include "core/base/text_field.h"

namespace waymark {

RangeCheck& RangeCheck::field(std::string_view name, double value, const Range& range) {
  if (!first_error_ && !range.contains(value)) {
    first_error_ = Error(ErrorKind::usage, fmt::format("{} is {}; it must be from {} to {}", name,
                                                       value, range.low, range.high));
  }
  return *this;
}

RangeCheck& RangeCheck::part(std::string_view name, const Status& checked) {
  if (!first_error_ && !checked) {
    first_error_ = Error(checked.error().kind, fmt::format("{}.{}", name, checked.error().message));
  }
  return *this;
}

Status RangeCheck::status() const {
  return first_error_ ? tl::make_unexpected(*first_error_) : Status{};
}

std::function<std::string(const std::string&)> number_in(Range range) {
  return [range](const std::string& text) -> std::string {
    const std::string_view digits = std::string_view(text).substr(text.starts_with('+') ? 1 : 0);
    const auto value = parse_whole<double>(digits);
    if (value && range.contains(*value)) return "";
    return fmt::format("{} is no number from {} to {}", in_one_line(text), range.low, range.high);
  };
}

}  // namespace waymark
