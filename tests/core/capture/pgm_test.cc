#include "core/capture/pgm.h"

#include <gmock/gmock.h>

#include "tests/support/bad_input.h"
#include "tests/support/test_pattern.h"

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Pgm, WrittenImageReadsBackToTheSame) {
  const GrayImage image = test_pattern(37, 21);
  const auto loaded = decode_pgm(encode_pgm(image.view()));
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->image.width_px, 37);
  EXPECT_EQ(loaded->image.height_px, 21);
  EXPECT_EQ(loaded->image.pixels, image.pixels);
  EXPECT_FALSE(loaded->deep);
  EXPECT_FALSE(loaded->orientation_ignored);
}

TEST(Pgm, RowsWithPaddingAreWrittenWithout) {
  const GrayImage image = test_pattern(8, 4);
  const GrayView left_half{image.pixels.data(), 4, 4, 8};
  const auto loaded = decode_pgm(encode_pgm(left_half));
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->image.row(1)[0], image.pixels[8]);
}

TEST(Pgm, CommentsInTheHeaderAreAllowed) {
  const auto loaded = decode_pgm("P5 # made by hand\n# twice\n2\t1 # wide\n255\nab");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_THAT(loaded->image.pixels, ElementsAre('a', 'b'));
}

TEST(Pgm, FirstPixelMayLookLikeABlank) {
  const auto loaded = decode_pgm("P5 2 1 255\n\n#");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_THAT(loaded->image.pixels, ElementsAre('\n', '#'));
}

TEST(Pgm, SixteenBitsAreBigEndianAndReducedToTheUpperEight) {
  const auto loaded = decode_pgm(std::string_view("P5 2 1 65535\n\x12\xFF\xFF\x00", 17));
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_THAT(loaded->image.pixels, ElementsAre(0x12, 0xFF));
  EXPECT_TRUE(loaded->deep);
}

TEST(Pgm, BitsInTheLowEndOfSixteenAreReadAsSuch) {
  const auto loaded = decode_pgm(std::string_view("P5 2 1 65535\n\x03\xFC\x02\x00", 17));
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_THAT(loaded->image.pixels, ElementsAre(255, 128));
  EXPECT_EQ(loaded->deep->largest, 1020);
  EXPECT_EQ(loaded->deep->bits_in_use, 10);
}

TEST(Pgm, AnotherSizeThanExpectedIsRefused) {
  EXPECT_TRUE(decode_pgm("P5 2 1 255\nab", ImageSize{2, 1}));
  const auto loaded = decode_pgm("P5 2 1 255\nab", ImageSize{1, 2});
  ASSERT_FALSE(loaded);
  EXPECT_THAT(loaded.error().message, HasSubstr("the image is 2×1, rig.yaml says 1×2"));
}

TEST(Pgm, OtherMaximaAreScaledTo255) {
  const auto twelve_bit = decode_pgm(std::string_view("P5 3 1 4095\n\x00\x00\x08\x00\x0F\xFF", 18));
  ASSERT_TRUE(twelve_bit) << twelve_bit.error().message;
  EXPECT_THAT(twelve_bit->image.pixels, ElementsAre(0, 128, 255));
  EXPECT_TRUE(twelve_bit->deep);
  const auto bilevel = decode_pgm(std::string_view("P5 3 1 1\n\x00\x01\x09", 12));
  ASSERT_TRUE(bilevel);
  EXPECT_THAT(bilevel->image.pixels, ElementsAre(0, 255, 255))
      << "above the maximum is the maximum";
}

class BadPgm : public testing::TestWithParam<BadInput> {};

TEST_P(BadPgm, IsRefused) {
  const auto loaded = decode_pgm(GetParam().text);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(loaded.error().message, HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Cases, BadPgm,
    testing::Values(BadInput{"Text", "P2\n1 1\n255\n7\n", "kind P2; only P5"},
                    BadInput{"Colour", "P6\n1 1\n255\nabc", "kind P6"},
                    BadInput{"NoSize", "P5\n", "damaged PGM header"},
                    BadInput{"ZeroWidth", "P5 0 1 255\n", "damaged PGM header"},
                    BadInput{"NegativeHeight", "P5 1 -1 255\nab", "damaged PGM header"},
                    BadInput{"HugeWidth", "P5 99999999999 1 255\n", "damaged PGM header"},
                    BadInput{"TooManyPixels", "P5 20000 10001 255\n", "more than 200 megapixels"},
                    BadInput{"MaximumTooLarge", "P5 1 1 65536\nab", "damaged PGM header"},
                    BadInput{"NothingAfterTheHeader", "P5 1 1 255", "damaged PGM header"},
                    BadInput{"OnePixelShort", "P5 2 2 255\nabc", "truncated PGM: 3 of 4"},
                    BadInput{"OneByteShort", "P5 2 1 300\nabc", "truncated PGM: 3 of 4"}),
    bad_input_name);

TEST(Pgm, KnownByItsBeginning) {
  EXPECT_TRUE(looks_like_pgm("P5\n1 1"));
  EXPECT_TRUE(looks_like_pgm("P2 1 1"));
  EXPECT_FALSE(looks_like_pgm("P5"));
  EXPECT_FALSE(looks_like_pgm("P8 1 1"));
  EXPECT_FALSE(looks_like_pgm("PS!\n"));
}

}  // namespace
}  // namespace waymark
