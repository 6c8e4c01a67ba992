#include "mapbuilder/import/unpacked_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/peak_memory.h"
#include "tests/support/recordings.h"

namespace waymark {
namespace {

using testing::HasSubstr;

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};  // NOLINT: bytes
}

/// Half noise, half zeros.
std::string content(std::size_t size) {
  std::mt19937 random(3);
  std::string text(size, '\0');
  for (std::size_t i = 0; i < size / 2; ++i) text[i] = static_cast<char>(random());
  return text;
}

Expected<std::string> all_of(ByteSource& source, std::size_t step) {
  std::string text;
  std::vector<std::uint8_t> buffer(step);
  for (;;) {
    const auto got = source.read(buffer);
    if (!got) return tl::make_unexpected(got.error());
    text.append(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(*got));
    if (*got < step) return text;
  }
}

struct Packing {
  const char* name;
  std::string (*pack)(std::string_view);
  std::unique_ptr<ByteSource> (*unpack)(ByteSource&);
};

class UnpackedSourceTest : public testing::TestWithParam<Packing> {};

TEST_P(UnpackedSourceTest, GivesWhatWasPackedInPiecesOfAnySize) {
  const std::string text = content(300'000);
  const std::string packed = GetParam().pack(text) + GetParam().pack("and a second frame");
  for (const std::size_t step : {1'000, 65'536, 1'000'000}) {
    SpanSource source(bytes_of(packed));
    const auto unpacked = GetParam().unpack(source);
    EXPECT_EQ(all_of(*unpacked, step).value(), text + "and a second frame") << step;
  }
}

TEST_P(UnpackedSourceTest, DamageIsSaid) {
  const std::string packed = GetParam().pack(content(3000));
  for (std::size_t size = 1; size < packed.size(); size += 7) {
    SpanSource source(bytes_of(packed).first(size));
    const auto unpacked = GetParam().unpack(source);
    const auto cut = all_of(*unpacked, 500);
    ASSERT_FALSE(cut) << size;
    EXPECT_THAT(cut.error().message, HasSubstr(GetParam().name));
  }
  SpanSource nonsense(bytes_of("no such frame at all"));
  EXPECT_FALSE(all_of(*GetParam().unpack(nonsense), 100));
  SpanSource nothing({});
  EXPECT_EQ(all_of(*GetParam().unpack(nothing), 100).value(), "");
}

TEST_P(UnpackedSourceTest, TakesTheMemoryOfItsWindow) {
  const std::string packed = GetParam().pack(std::string(200'000'000, 'x'));
  const std::size_t memory = test::peak_memory([&] {
    SpanSource source(bytes_of(packed));
    const auto unpacked = GetParam().unpack(source);
    EXPECT_TRUE(*pass_over(*unpacked, 200'000'000));
  });
  EXPECT_LT(memory, 40'000'000U);
}

INSTANTIATE_TEST_SUITE_P(
    Packings, UnpackedSourceTest,
    testing::Values(
        Packing{"zstd", [](std::string_view text) { return test::zstd_of(text); }, unpacked_zstd},
        Packing{"lz4", [](std::string_view text) { return test::lz4_of(text); }, unpacked_lz4}),
    [](const auto& info) { return info.param.name; });

TEST(UnpackedZstd, LargerWindowsThanRecordersAskForAreRefused) {
  const std::string text = content(40'000'000);
  for (const int log : {kMaxZstdWindowLog, kMaxZstdWindowLog + 1}) {
    const std::string packed = test::zstd_of(text, log);
    SpanSource source(bytes_of(packed));
    const auto unpacked = unpacked_zstd(source);
    EXPECT_EQ(all_of(*unpacked, 1 << 20).has_value(), log == kMaxZstdWindowLog);
  }
}

TEST(UnpackZstd, EndsAtItsLimit) {
  const std::string packed = test::zstd_of(std::string(3'000'000, 'x'));
  EXPECT_EQ(unpack_zstd(bytes_of(packed), 3'000'000).value().size(), 3'000'000U);
  EXPECT_FALSE(unpack_zstd(bytes_of(packed), 2'999'999));
  EXPECT_TRUE(looks_like_zstd(bytes_of(packed)));
  EXPECT_FALSE(looks_like_zstd(bytes_of("\x28\xB5\x2F")));
}

}  // namespace
}  // namespace waymark
