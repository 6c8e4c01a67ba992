#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.h"

namespace waymark::test {

/// What a parser makes of one input: nullopt when it was taken.
using Reader = std::function<std::optional<Error>(const std::string&)>;

template <typename Read>
[[nodiscard]] Reader reader(Read read) {
  return [read](const std::string& input) -> std::optional<Error> {
    const auto result = read(input);
    if (result) return std::nullopt;
    return result.error();
  };
}

/// A form of input that comes from outside. Each stands in a file of tests/fuzz/formats, which adds
/// it to formats(); damaged_inputs_test has them all, a libFuzzer binary has one.
struct Format {
  std::string name;
  std::vector<std::string> seeds;  ///< inputs that are taken
  std::vector<std::string> words;  ///< what the form is made of, for libFuzzer
  Reader read;
};

[[nodiscard]] inline std::vector<Format>& formats() {
  static std::vector<Format> all;
  return all;
}

struct AddFormat {
  explicit AddFormat(Format format) { formats().push_back(std::move(format)); }
};

}  // namespace waymark::test
