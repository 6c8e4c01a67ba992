#include "core/base/atomic_file.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>

#include "tests/support/temporary_folder.h"

namespace {
std::atomic<int> umask_calls{0};
}  // namespace

/// The whole executable's, counted.
extern "C" mode_t umask(mode_t mask) noexcept {
  ++umask_calls;
  return static_cast<mode_t>(::syscall(SYS_umask, mask));
}

namespace waymark {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::size_t count_entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

TEST(AtomicFile, WritesReplacesAndReadsBack) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "map";
  ASSERT_TRUE(write_file_atomically(file, "first"));
  const std::string binary("\0second\n\xFF", 9);
  ASSERT_TRUE(write_file_atomically(file, binary));
  EXPECT_EQ(*read_file(file), binary);
  EXPECT_EQ(count_entries(folder.path()), 1U) << "a temporary file is left over";
}

TEST(AtomicFile, WritesEmptyContentAndManyBytes) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file_atomically(folder.path() / "empty", ""));
  EXPECT_EQ(*read_file(folder.path() / "empty"), "");
  const std::string many(300'000, 'x');
  ASSERT_TRUE(write_file_atomically(folder.path() / "many", many));
  EXPECT_EQ(*read_file(folder.path() / "many"), many);
}

TEST(AtomicFile, AbsentFolderCantBeWrittenTo) {
  const TemporaryFolder folder;
  const auto status = write_file_atomically(folder.path() / "absent" / "map", "x");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::cant_create);
  EXPECT_THAT(status.error().message, HasSubstr("absent"));
}

TEST(AtomicFile, FolderIsNotReplacedByAFile) {
  const TemporaryFolder folder;
  const auto status = write_file_atomically(folder.path(), "x");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::cant_create);
  EXPECT_TRUE(fs::is_directory(folder.path()));
}

TEST(AtomicFile, ALinkStaysALinkAlsoWhereItsTargetIsNotThereYet) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "maps");
  fs::create_symlink("maps/hall.map", folder.path() / "link");
  fs::create_symlink("link", folder.path() / "second");
  for (const char* content : {"first", "again"}) {
    const auto written = write_file_atomically(folder.path() / "second", content);
    ASSERT_TRUE(written) << written.error().message;
    EXPECT_EQ(folder.read("maps/hall.map"), content);
    EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
    EXPECT_TRUE(fs::is_symlink(folder.path() / "second"));
  }
  fs::create_symlink(folder.path() / "absent" / "hall.map", folder.path() / "nowhere");
  EXPECT_EQ(write_file_atomically(folder.path() / "nowhere", "x").error().kind,
            ErrorKind::cant_create);
  EXPECT_TRUE(fs::is_symlink(folder.path() / "nowhere"));
}

TEST(AtomicFile, LinksThatLeadInCirclesAreRefused) {
  const TemporaryFolder folder;
  fs::create_symlink("self", folder.path() / "self");
  fs::create_symlink("b", folder.path() / "a");
  fs::create_symlink("a", folder.path() / "b");
  for (const char* name : {"self", "a", "self/below", "a/below"}) {
    const auto status = write_file_atomically(folder.path() / name, "x");
    ASSERT_FALSE(status) << name;
    EXPECT_EQ(status.error().kind, ErrorKind::cant_create) << name;
  }
  EXPECT_TRUE(fs::is_symlink(folder.path() / "self"));
}

TEST(AtomicFile, WhatIsReplacedKeepsItsMode) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("map", "good");
  for (const unsigned mode : {0600U, 0640U, 0666U, 0755U}) {
    fs::permissions(file, static_cast<fs::perms>(mode));
    ASSERT_TRUE(write_file_atomically(file, "better"));
    EXPECT_EQ(static_cast<unsigned>(fs::status(file).permissions()), mode);
  }
}

TEST(AtomicFile, NamesMayBeAsLongAsTheSystemAllows) {
  const TemporaryFolder folder;
  const std::string longest(255, 'm');
  const auto written = write_file_atomically(folder.path() / longest, "x");
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(folder.read(longest), "x");
  EXPECT_EQ(count_entries(folder.path()), 1U) << "a temporary file is left over";
  const auto longer = write_file_atomically(folder.path() / (longest + "m"), "x");
  ASSERT_FALSE(longer);
  EXPECT_EQ(longer.error().kind, ErrorKind::io);
  EXPECT_EQ(count_entries(folder.path()), 1U) << "a temporary file is left over";
}

/// Runs in a child process, because the limit holds for all of it.
[[noreturn]] void write_beyond_the_limit(const fs::path& file) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{.rlim_cur = 4096, .rlim_max = 4096};
  if (setrlimit(RLIMIT_FSIZE, &limit) != 0) std::_Exit(1);
  const auto status = write_file_atomically(file, std::string(100'000, 'x'));
  std::_Exit(!status && status.error().kind == ErrorKind::io ? 74 : 1);
}

TEST(AtomicFileDeathTest, FullDiskLeavesTheEarlierContentAndNothingElse) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("map", "good");
  EXPECT_EXIT(write_beyond_the_limit(file), testing::ExitedWithCode(74), "");
  EXPECT_EQ(folder.read("map"), "good");
  EXPECT_EQ(count_entries(folder.path()), 1U) << "a temporary file is left over";
}

TEST(AtomicFile, FollowsTheUmask) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file_atomically(folder.path() / "map", "x"));
  const mode_t mask = ::umask(0);
  ::umask(mask);
  const auto mode = static_cast<unsigned>(fs::status(folder.path() / "map").permissions());
  EXPECT_EQ(mode, 0666U & ~mask);
}

TEST(AtomicFile, NeverChangesTheUmaskWhichIsAllThreads) {
  const TemporaryFolder folder;
  const int before = umask_calls;
  ASSERT_TRUE(write_file_atomically(folder.path() / "map", "x"));
  EXPECT_EQ(umask_calls, before);
}

TEST(ReadFile, APipeIsNotWaitedFor) {
  const TemporaryFolder folder;
  const fs::path pipe = folder.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const auto content = read_file(pipe);
  ASSERT_FALSE(content);
  EXPECT_EQ(content.error().kind, ErrorKind::no_input);
  EXPECT_THAT(content.error().message, HasSubstr("no regular file"));
}

TEST(ReadFile, SaysWhyItCant) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_file(folder.path() / "absent").error().kind, ErrorKind::no_input);
  EXPECT_EQ(read_file(folder.path()).error().kind, ErrorKind::no_input);
  const fs::path file = folder.write("file", "0123456789");
  EXPECT_TRUE(read_file(file, 10));
  EXPECT_EQ(read_file(file, 9).error().kind, ErrorKind::bad_data);
  if (::geteuid() != 0) {  // the superuser may read everything
    fs::permissions(file, fs::perms::none);
    EXPECT_EQ(read_file(file).error().kind, ErrorKind::permission);
  }
}

}  // namespace
}  // namespace waymark
