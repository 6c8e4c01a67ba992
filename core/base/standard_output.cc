#include "core/base/standard_output.h"

#include <cstdio>
#include <iostream>

#include "core/base/error.h"

namespace waymark {

int exit_code_after_output(int code, std::string_view program) {
  std::cout.flush();
  const bool arrived = std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout.good();
  if (code != 0 || arrived) return code;
  std::cerr << program << ": can't write to standard output\n";
  return static_cast<int>(ErrorKind::io);
}

}  // namespace waymark
