#pragma once

#include <cstdio>
#include <cstdlib>

/// A condition whose failure is a bug of our own, never bad input. Always on, in every build.
#define WAYMARK_CHECK(condition)                                                     \
  do {                                                                               \
    if (!(condition)) {                                                              \
      std::fprintf(stderr, "%s:%d: internal check failed: %s\n", __FILE__, __LINE__, \
                   #condition); /* NOLINT(cppcoreguidelines-pro-type-vararg) */      \
      std::abort();                                                                  \
    }                                                                                \
  } while (false)
