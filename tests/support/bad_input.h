#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <string>

namespace waymark {

/// Text that a reader must refuse, and what its message must say; for parameterized tests.
struct BadInput {
  const char* name;
  const char* text;
  const char* message;
};

/// Without it GoogleTest would print addresses, and the tests' names would change from run to run.
inline std::ostream& operator<<(std::ostream& out, const BadInput& input) {
  return out << input.name;
}

inline std::string bad_input_name(const testing::TestParamInfo<BadInput>& info) {
  return info.param.name;
}

}  // namespace waymark
