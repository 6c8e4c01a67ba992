#include "core/base/standard_output.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

namespace waymark {
namespace {

/// The exit code of a process that prints by `print` to `device` and would end with `code`.
template <typename Print>
int exit_code(const char* device, int code, const Print& print) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::cerr.setstate(std::ios::badbit);  // what is said there is told by the programs' tests
    if (std::freopen(device, "w", stdout) == nullptr) ::_exit(126);
    print();
    ::_exit(exit_code_after_output(code, "test"));
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(StandardOutput, WhatDoesNotArriveIsAnError) {
  const auto by_c = [] { std::printf("some text\n"); };
  const auto by_cpp = [] { std::cout << "some text\n"; };
  const auto much = [] {
    for (int i = 0; i < 100'000; ++i) std::printf("some text\n");
  };
  EXPECT_EQ(exit_code("/dev/full", 0, by_c), 74);
  EXPECT_EQ(exit_code("/dev/full", 0, by_cpp), 74);
  EXPECT_EQ(exit_code("/dev/full", 0, much), 74);
  EXPECT_EQ(exit_code("/dev/full", 0, [] {}), 0) << "nothing was printed";
  EXPECT_EQ(exit_code("/dev/null", 0, by_c), 0);
  EXPECT_EQ(exit_code("/dev/null", 0, by_cpp), 0);
}

TEST(StandardOutput, AnEarlierErrorStaysTheError) {
  EXPECT_EQ(exit_code("/dev/full", 65, [] { std::printf("some text\n"); }), 65);
}

TEST(StandardOutput, AClosedOneIsAnErrorToo) {
  EXPECT_EQ(exit_code("/dev/null", 0,
                      [] {
                        ::close(STDOUT_FILENO);
                        std::printf("some text\n");
                      }),
            74);
}

}  // namespace
}  // namespace waymark
