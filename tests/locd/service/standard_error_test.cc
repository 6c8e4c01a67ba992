#include "locd/service/standard_error.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <csignal>

#include "core/base/descriptor.h"

namespace waymark {
namespace {

struct Pipe {
  Pipe() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
    reader = Descriptor(ends[0]);
    writer = Descriptor(ends[1]);
  }
  [[nodiscard]] std::string read() const {
    std::string text(1 << 20, '\0');
    const ssize_t size = ::read(reader.get(), text.data(), text.size());
    text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
    return text;
  }
  Descriptor reader;
  Descriptor writer;
};

TEST(OfferLine, ALineIsWrittenWithItsEnd) {
  const Pipe pipe;
  EXPECT_TRUE(offer_line("all is well", pipe.writer.get()));
  EXPECT_EQ(pipe.read(), "all is well\n");
}

TEST(OfferLine, APipeThatNobodyReadsIsNotWaitedForAndTakesWholeLinesOnly) {
  const Pipe pipe;
  std::size_t taken = 0;
  while (offer_line(std::string(3000, 'n'), pipe.writer.get())) ++taken;
  EXPECT_GT(taken, 0U);
  EXPECT_EQ(pipe.read().size(), taken * 3001);
  EXPECT_TRUE(offer_line("again", pipe.writer.get()));
}

TEST(OfferLine, OneThatIsTooLongEndsWhereAPipeWouldPartIt) {
  const Pipe pipe;
  std::string whole(kMaxOfferedBytes, 'n');
  whole.back() = '\n';
  for (const std::size_t size : {kMaxOfferedBytes - 1, kMaxOfferedBytes, 10 * kMaxOfferedBytes}) {
    EXPECT_TRUE(offer_line(std::string(size, 'n'), pipe.writer.get()));
    EXPECT_EQ(pipe.read(), whole);
  }
}

TEST(OfferLine, WithoutAReaderItIsLost) {
  Pipe pipe;
  pipe.reader = Descriptor();
  ::signal(SIGPIPE, SIG_IGN);
  EXPECT_FALSE(offer_line("nobody", pipe.writer.get()));
  EXPECT_FALSE(offer_line("nobody", -1));
  ::signal(SIGPIPE, SIG_DFL);
}

}  // namespace
}  // namespace waymark
