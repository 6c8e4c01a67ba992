#include "core/base/system_call.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <string>
#include <thread>

namespace waymark {
namespace {

TEST(WriteAll, BringsMoreThanAPipeHoldsAcross) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  std::string read;
  std::thread reader([&] {
    std::array<char, 999> block{};
    for (ssize_t got = 0; (got = ::read(pipe[0], block.data(), block.size())) > 0;) {
      read.append(block.data(), static_cast<std::size_t>(got));
    }
  });
  const std::string sent(1'000'000, 'x');
  EXPECT_TRUE(write_all(pipe[1], sent));
  ::close(pipe[1]);
  reader.join();
  ::close(pipe[0]);
  EXPECT_EQ(read, sent);
}

TEST(WriteAll, SaysByErrnoWhyItCannot) {
  EXPECT_FALSE(write_all(-1, "x"));
  EXPECT_EQ(errno, EBADF);
  EXPECT_EQ(system_reason(), "Bad file descriptor");
  EXPECT_TRUE(write_all(-1, "")) << "nothing to write";
}

TEST(CreationError, IsAboutPermissionOrPlace) {
  for (const int number : {EACCES, EPERM, EROFS}) {
    errno = number;
    EXPECT_EQ(creation_error(), ErrorKind::permission) << number;
  }
  for (const int number : {ENOENT, ENOSPC, ENOTDIR}) {
    errno = number;
    EXPECT_EQ(creation_error(), ErrorKind::cant_create) << number;
  }
}

}  // namespace
}  // namespace waymark
