#include "core/marker/marker_catalog.h"

#include <gmock/gmock.h>

#include <ctime>

#include "tests/support/bad_input.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using testing::HasSubstr;

MarkerId tag(int number) { return {Family::tag36h11, number}; }

MarkerCatalog parsed(std::string_view text) {
  auto catalog = parse_marker_catalog(text, "markers.toml");
  EXPECT_TRUE(catalog) << catalog.error().message;
  return catalog ? *catalog : MarkerCatalog();
}

constexpr std::string_view kMixedSizes = R"([markers]
family = "tag36h11"
size_m = 0.30
ignore = "200-220"
[[markers.sizes]]
ids = "100-199, 205"
size_m = 0.25
[[markers.sizes]]
ids = [7, 9]
size_m = 1
)";

TEST(MarkerCatalog, SizesByDefaultRangeAndList) {
  const MarkerCatalog catalog = parsed(kMixedSizes);
  EXPECT_EQ(catalog.size_m(tag(0)), 0.30);
  EXPECT_EQ(catalog.size_m(tag(99)), 0.30);
  EXPECT_EQ(catalog.size_m(tag(100)), 0.25);
  EXPECT_EQ(catalog.size_m(tag(199)), 0.25);
  EXPECT_EQ(catalog.size_m(tag(7)), 1.0);
  EXPECT_EQ(catalog.size_m(tag(8)), 0.30);
  EXPECT_EQ(catalog.size_m(tag(200)), std::nullopt);
  EXPECT_EQ(catalog.size_m(tag(205)), std::nullopt) << "ignore beats sizes";
  EXPECT_EQ(catalog.size_m(tag(221)), 0.30);
}

TEST(MarkerCatalog, WhatMovesTogetherIsAGroup) {
  const MarkerCatalog catalog = parsed(
      "[[markers]]\nfamily = \"tag36h11\"\nsize_m = 0.3\n"
      "[[markers.sizes]]\nids = \"7-8\"\nsize_m = 0.1\ngroup = \"shelf 12\"\n"
      "[[markers.sizes]]\nids = [9]\nsize_m = 0.1\ngroup = 'Tür \"A\" \\'\n"
      "[[markers.sizes]]\nids = [10]\nsize_m = 0.1\n"
      "[[markers]]\nfamily = \"tag25h9\"\n"
      "[[markers.sizes]]\nids = [1]\nsize_m = 0.1\ngroup = \"shelf 12\"\n");
  for (const MarkerCatalog& one : {catalog, parsed(format_marker_catalog(catalog))}) {
    EXPECT_EQ(one.group(tag(7)), "shelf 12");
    EXPECT_EQ(one.group(tag(8)), "shelf 12");
    EXPECT_EQ(one.group(tag(9)), "Tür \"A\" \\");
    EXPECT_EQ(one.group(tag(10)), "");
    EXPECT_EQ(one.group(tag(0)), "");
    EXPECT_EQ(one.group({Family::tag25h9, 1}), "shelf 12");
    EXPECT_EQ(one.size_m(tag(7)), 0.1);
  }
  EXPECT_EQ(catalog.fingerprint(), parsed("[[markers]]\nfamily = \"tag36h11\"\nsize_m = 0.3\n"
                                          "[[markers.sizes]]\nids = \"7-10\"\nsize_m = 0.1\n"
                                          "[[markers]]\nfamily = \"tag25h9\"\n"
                                          "[[markers.sizes]]\nids = [1]\nsize_m = 0.1\n")
                                       .fingerprint())
      << "no detection depends on it";
}

TEST(MarkerCatalog, AGroupIsAShortPrintableText) {
  const auto with = [](std::string_view ids, std::string_view group) {
    return parse_marker_catalog(
        fmt::format("[markers]\nfamily = \"tag36h11\"\n"
                    "[[markers.sizes]]\nids = \"7-8\"\nsize_m = 1\ngroup = \"a\"\n"
                    "[[markers.sizes]]\nids = \"{}\"\nsize_m = 1\ngroup = {}\n",
                    ids, group),
        "markers.toml");
  };
  EXPECT_TRUE(with("9", fmt::format("\"{:x<80}\"", "")));
  for (const std::string_view group :
       {"12", "\"\"", "\"a\\nb\"", "\"\\u001b[2J\"", "[\"a\"]", "true"}) {
    const auto read = with("9", group);
    ASSERT_FALSE(read) << group;
    EXPECT_EQ(read.error().exit_code(), 65);
    EXPECT_THAT(read.error().message, HasSubstr("group must be"));
  }
  EXPECT_FALSE(with("9", fmt::format("\"{:x<81}\"", "")));
  EXPECT_FALSE(with("8-9", "\"b\"")) << "8 in two groups";
}

TEST(MarkerCatalog, SizesHaveSigmas) {
  const MarkerCatalog catalog = parsed(
      "[markers]\nfamily = \"tag36h11\"\nsize_m = 0.3\nsize_sigma_m = 0.001\n"
      "[[markers.sizes]]\nids = \"7-8\"\nsize_m = 0.1\nsize_sigma_m = 0.00005\n"
      "[[markers.sizes]]\nids = [9]\nsize_m = 0.1\n");
  EXPECT_EQ(catalog.size_sigma_m(tag(0)), 0.001);
  EXPECT_EQ(catalog.size_sigma_m(tag(8)), 0.00005);
  EXPECT_EQ(catalog.size_sigma_m(tag(9)), 0.0002) << "0.2 mm where nobody says";
  EXPECT_EQ(default_size_sigma_m(0.5), 0.0005) << "a thousandth of large ones";
  EXPECT_EQ(parsed("[markers]\nfamily = \"tag36h11\"\n[[markers.sizes]]\nids = [1]\nsize_m = 1\n")
                .size_sigma_m(tag(2)),
            std::nullopt);
  const MarkerCatalog again = parsed(format_marker_catalog(catalog));
  for (const int id : {0, 7, 8, 9}) {
    EXPECT_EQ(again.size_sigma_m(tag(id)), catalog.size_sigma_m(tag(id)));
  }
  EXPECT_EQ(catalog.with_exact_sizes().fingerprint(), catalog.fingerprint())
      << "a sigma makes no detections stale";
  EXPECT_LT(*catalog.with_exact_sizes().size_sigma_m(tag(9)), 1e-8);
}

TEST(MarkerCatalog, SigmasOfSizesAreAboveZeroAndBelowTheSize) {
  for (const std::string bad : {"-0.001", "0", "nan", "0.3", "\"a\""}) {
    const auto catalog = parse_marker_catalog(
        "[markers]\nfamily = \"tag36h11\"\nsize_m = 0.3\nsize_sigma_m = " + bad + "\n", "m.toml");
    ASSERT_FALSE(catalog) << bad;
    EXPECT_THAT(
        catalog.error().message,
        HasSubstr("m.toml: line 4: size_sigma_m must be a number above 0 and below size_m"));
  }
  const auto without =
      parse_marker_catalog("[markers]\nfamily = \"tag36h11\"\nsize_sigma_m = 0.1\n", "m.toml");
  ASSERT_FALSE(without);
  EXPECT_THAT(without.error().message, HasSubstr("without a size_m beside it"));
}

TEST(MarkerCatalog, PrintScaleMultipliesItsBlocksSizes) {
  const MarkerCatalog catalog = parsed(
      "[[markers]]\nfamily = \"tag36h11\"\nprint_scale = 0.5\nsize_m = 0.4\n"
      "[[markers.sizes]]\nids = [7]\nsize_m = 1\n"
      "[[markers]]\nfamily = \"tag25h9\"\nsize_m = 0.3\n");
  EXPECT_EQ(catalog.size_m(tag(0)), 0.2);
  EXPECT_EQ(catalog.size_m(tag(7)), 0.5);
  EXPECT_EQ(catalog.size_m({Family::tag25h9, 0}), 0.3);
  EXPECT_EQ(catalog.entries()[0].print_scale, 0.5);
  EXPECT_EQ(catalog.entries()[1].print_scale, 1);
  EXPECT_EQ(parsed(format_marker_catalog(catalog)).fingerprint(), catalog.fingerprint());
}

TEST(MarkerCatalog, MarkersOutsideItHaveNoSize) {
  const MarkerCatalog catalog = parsed(kMixedSizes);
  EXPECT_EQ(catalog.size_m({Family::tag36h10, 0}), std::nullopt);
  EXPECT_EQ(catalog.size_m(tag(587)), std::nullopt);
  EXPECT_EQ(catalog.size_m(tag(-1)), std::nullopt);
  EXPECT_EQ(MarkerCatalog().size_m(tag(0)), std::nullopt);
}

TEST(MarkerCatalog, WithoutDefaultOnlyListedIdsExist) {
  const MarkerCatalog catalog = parsed(
      "[markers]\nfamily = \"aruco_4x4_1000\"\n[[markers.sizes]]\nids = \"3-4\"\nsize_m = 0.1\n");
  EXPECT_EQ(catalog.size_m({Family::aruco_4x4_1000, 3}), 0.1);
  EXPECT_EQ(catalog.size_m({Family::aruco_4x4_1000, 5}), std::nullopt);
}

TEST(MarkerCatalog, SeveralFamilies) {
  const MarkerCatalog one = parsed(kMixedSizes);
  EXPECT_EQ(one.only_family(), Family::tag36h11);
  EXPECT_EQ(one.format(tag(3)), "3");

  const MarkerCatalog two = parsed(
      "[[markers]]\nfamily = \"tag36h11\"\nsize_m = 0.1\n"
      "[[markers.sizes]]\nids = \"5\"\nsize_m = 0.2\n"
      "[[markers]]\nfamily = \"aruco_original\"\nsize_m = 0.3\n"
      "[[markers.sizes]]\nids = \"5\"\nsize_m = 0.4\n");
  EXPECT_TRUE(two.several_families());
  EXPECT_EQ(two.only_family(), std::nullopt);
  EXPECT_EQ(two.format(tag(3)), "tag36h11:3");
  EXPECT_EQ(two.size_m(tag(5)), 0.2);
  EXPECT_EQ(two.size_m({Family::aruco_original, 5}), 0.4);
}

TEST(MarkerCatalog, ByteOrderMarkAndCrlfAreAllowed) {
  EXPECT_EQ(parsed("\xEF\xBB\xBF[markers]\r\nfamily = \"tag16h5\"\r\nsize_m = 0.1\r\n")
                .size_m({Family::tag16h5, 29}),
            0.1);
}

TEST(MarkerCatalog, WrittenTextReadsBackToTheSame) {
  for (const std::string_view text :
       {kMixedSizes,
        std::string_view("[[markers]]\nfamily = \"tag16h5\"\nsize_m = 0.1\n"
                         "[[markers]]\nfamily = \"tag25h9\"\nsize_m = 0.333333333333\n")}) {
    const MarkerCatalog catalog = parsed(text);
    const MarkerCatalog again = parsed(format_marker_catalog(catalog));
    EXPECT_EQ(format_marker_catalog(again), format_marker_catalog(catalog));
    EXPECT_EQ(again.fingerprint(), catalog.fingerprint());
    for (int number = 0; number < 587; ++number) {
      EXPECT_EQ(again.size_m(tag(number)), catalog.size_m(tag(number)));
    }
  }
}

TEST(MarkerCatalog, FingerprintFollowsTheContentNotTheText) {
  const MarkerCatalog catalog = parsed(kMixedSizes);
  EXPECT_EQ(catalog.fingerprint().size(), 16U);
  EXPECT_EQ(
      parsed("# a comment\n[[markers]]\nsize_m = 0.3\nfamily = 'tag36h11'\nignore = '200-220'\n"
             "[[markers.sizes]]\nids = [9, 7]\nsize_m = 1.0\n"
             "[[markers.sizes]]\nids = '100-150, 151-199, 205'\nsize_m = 0.25\n")
          .fingerprint(),
      catalog.fingerprint());
  const std::string ab =
      "[[markers]]\nfamily='tag16h5'\nsize_m=1\n[[markers]]\nfamily='tag25h9'\nsize_m=2\n";
  const std::string ba =
      "[[markers]]\nfamily='tag25h9'\nsize_m=2\n[[markers]]\nfamily='tag16h5'\nsize_m=1\n";
  EXPECT_EQ(parsed(ab).fingerprint(), parsed(ba).fingerprint());
  for (const char* other :
       {"[markers]\nfamily='tag36h11'\nsize_m=0.3\n", "[markers]\nfamily='tag36h10'\nsize_m=0.3\n",
        "[markers]\nfamily='tag36h11'\nsize_m=0.3000001\n",
        "[markers]\nfamily='tag36h11'\nsize_m=0.3\nignore='1'\n"}) {
    EXPECT_NE(parsed(other).fingerprint(), catalog.fingerprint()) << other;
  }
}

class BadMarkersToml : public testing::TestWithParam<BadInput> {};

TEST_P(BadMarkersToml, IsRefusedInOneLine) {
  const auto catalog = parse_marker_catalog(GetParam().text, "markers.toml");
  ASSERT_FALSE(catalog);
  EXPECT_EQ(catalog.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(catalog.error().message, HasSubstr("markers.toml: "));
  EXPECT_THAT(catalog.error().message, HasSubstr(GetParam().message));
  EXPECT_EQ(catalog.error().message.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, BadMarkersToml,
    testing::Values(
        BadInput{"Empty", "", "no [markers] block"},
        BadInput{"NotToml", "[markers\n", "line 1: not valid TOML"},
        BadInput{"PrintScaleTooSmall", "[markers]\nfamily='tag36h11'\nsize_m=1\nprint_scale=0.49\n",
                 "print_scale"},
        BadInput{"PrintScaleTooLarge", "[markers]\nfamily='tag36h11'\nsize_m=1\nprint_scale=2.01\n",
                 "print_scale"},
        BadInput{"PrintScaleNan", "[markers]\nfamily='tag36h11'\nsize_m=1\nprint_scale=nan\n",
                 "print_scale"},
        BadInput{"MarkersNoTable", "markers = 3\n", "no [markers] block"},
        BadInput{"NoFamily", "[markers]\nsize_m = 0.1\n", "no family"},
        BadInput{"UnknownFamily", "[markers]\nfamily = \"tag99\"\nsize_m = 0.1\n",
                 "line 2: unknown family \"tag99\"; known: aruco_4x4_50"},
        BadInput{"FamilyNoText", "[markers]\nfamily = 36\nsize_m = 0.1\n", "line 2: no family"},
        BadInput{"NegativeSize", "[markers]\nfamily = \"tag36h11\"\nsize_m = -0.1\n",
                 "line 3: size_m must be a number above 0"},
        BadInput{"ZeroSize", "[markers]\nfamily = \"tag36h11\"\nsize_m = 0\n", "size_m must be"},
        BadInput{"NanSize", "[markers]\nfamily = \"tag36h11\"\nsize_m = nan\n", "size_m must be"},
        BadInput{"InfiniteSize", "[markers]\nfamily = \"tag36h11\"\nsize_m = inf\n",
                 "size_m must be"},
        BadInput{"SizeInMillimetres", "[markers]\nfamily = \"tag36h11\"\nsize_m = 120\n",
                 "at most 100"},
        BadInput{"SizeAsText", "[markers]\nfamily = \"tag36h11\"\nsize_m = \"0.1\"\n",
                 "size_m must be"},
        BadInput{"NoSize", "[markers]\nfamily = \"tag36h11\"\n", "has no size"},
        BadInput{"UnknownKey", "[markers]\nfamily = \"tag36h11\"\nsize = 0.1\n",
                 "line 3: unknown key \"size\""},
        BadInput{"UnknownTopKey", "[marker]\nfamily = \"tag36h11\"\n", "unknown key \"marker\""},
        BadInput{"IdInTwoRanges",
                 "[markers]\nfamily = \"tag36h11\"\n[[markers.sizes]]\nids = \"1-5\"\nsize_m = 1\n"
                 "[[markers.sizes]]\nids = \"5-9\"\nsize_m = 2\n",
                 "line 7: id 5 has a size already"},
        BadInput{"IdTwiceInOneRange",
                 "[markers]\nfamily = \"tag36h11\"\n[[markers.sizes]]\nids = [3, 3]\nsize_m = 1\n",
                 "id 3 has a size already"},
        BadInput{"IgnoredInTwoRanges",
                 "[markers]\nfamily = \"tag36h11\"\nsize_m = 1\nignore = \"1-5, 9, 5-7\"\n",
                 "line 4: id 5 is ignored already; it stands in two ranges"},
        BadInput{"IgnoredTwice",
                 "[markers]\nfamily = \"tag36h11\"\nsize_m = 1\nignore = [4, 3, 3]\n",
                 "line 4: id 3 is ignored already"},
        BadInput{"IdOutsideTheFamily",
                 "[markers]\nfamily = \"tag16h5\"\nsize_m = 1\nignore = \"29-30\"\n",
                 "line 4: id 30: tag16h5 has the ids 0 to 29"},
        BadInput{"BackwardRange",
                 "[markers]\nfamily = \"tag36h11\"\nsize_m = 1\nignore = \"9-3\"\n",
                 "\"9-3\" is no id"},
        BadInput{"NegativeId", "[markers]\nfamily = \"tag36h11\"\nsize_m = 1\nignore = [-1]\n",
                 "\"-1\" is no id"},
        BadInput{"EmptyRange", "[markers]\nfamily = \"tag36h11\"\nsize_m = 1\nignore = \"1,,2\"\n",
                 "\"\" is no id"},
        BadInput{"WordRange", "[markers]\nfamily = \"tag36h11\"\nsize_m = 1\nignore = \"all\"\n",
                 "\"all\" is no id"},
        BadInput{"HugeRange",
                 "[markers]\nfamily = \"tag36h11\"\nsize_m = 1\nignore = \"0-2000000000\"\n",
                 "id 2000000000"},
        BadInput{"IdsNoListNorText", "[markers]\nfamily = \"tag36h11\"\nsize_m = 1\nignore = 3.5\n",
                 "ids must be"},
        BadInput{"SizesWithoutIds",
                 "[markers]\nfamily = \"tag36h11\"\n[[markers.sizes]]\nsize_m = 1\n",
                 "needs ids and size_m"},
        BadInput{"SizesNoBlocks", "[markers]\nfamily = \"tag36h11\"\nsizes = 3\n",
                 "sizes must be [[markers.sizes]]"},
        BadInput{"FamilyThatBeginsAnother",
                 "[[markers]]\nfamily = \"aruco_4x4_50\"\nsize_m = 1\n"
                 "[[markers]]\nfamily = \"aruco_4x4_1000\"\nsize_m = 2\n",
                 "line 4: aruco_4x4_50 is the beginning of aruco_4x4_1000"},
        BadInput{"FamilyThatBeginsWithAnother",
                 "[[markers]]\nfamily = \"aruco_6x6_250\"\nsize_m = 1\n"
                 "[[markers]]\nfamily = \"tag36h11\"\nsize_m = 1\n"
                 "[[markers]]\nfamily = \"aruco_6x6_100\"\nsize_m = 2\n",
                 "line 7: aruco_6x6_100 is the beginning of aruco_6x6_250"},
        BadInput{"FamilyTwice",
                 "[[markers]]\nfamily = \"tag16h5\"\nsize_m = 1\n"
                 "[[markers]]\nfamily = \"tag16h5\"\nsize_m = 2\n",
                 "line 4: family \"tag16h5\" has two blocks"}),
    bad_input_name);

TEST(MarkerCatalog, ManyRangesOfAllIdsTakeNoMoreThanASecondAndAMicrosecondPerByte) {
  std::string ranges;
  while (ranges.size() < 100'000) ranges += "0-48000,";
  const std::string head = "[markers]\nfamily = \"tagstandard52h13\"\n";
  for (const std::string& text :
       {head + "size_m = 1\nignore = \"" + ranges + "1\"\n",
        head + "[[markers.sizes]]\nsize_m = 1\nids = \"" + ranges + "1\"\n"}) {
    const std::clock_t begin = std::clock();
    const auto catalog = parse_marker_catalog(text, "markers.toml");
    const double cpu_s = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    ASSERT_FALSE(catalog);
    EXPECT_THAT(catalog.error().message, HasSubstr("id 0 "));
    EXPECT_LT(cpu_s, 1 + 1e-6 * static_cast<double>(text.size()));
  }
}

TEST(MarkerCatalog, InvertedPrintsAreSeenLight) {
  const MarkerCatalog catalog = parsed(
      "[[markers]]\nfamily = \"tag36h11\"\nsize_m = 0.1\ninverted = true\n"
      "[[markers]]\nfamily = \"tag25h9\"\nsize_m = 0.1\n"
      "[[markers]]\nfamily = \"tagStandard41h12\"\nsize_m = 0.1\n");
  EXPECT_TRUE(catalog.shows_light_squares(Family::tag36h11));
  EXPECT_FALSE(catalog.shows_light_squares(Family::tag25h9));
  EXPECT_TRUE(catalog.shows_light_squares(Family::tagstandard41h12));
  EXPECT_FALSE(catalog.shows_light_squares(Family::tag16h5)) << "is not in the catalog";
  const MarkerCatalog again = parsed(format_marker_catalog(catalog));
  EXPECT_TRUE(again.shows_light_squares(Family::tag36h11));
  EXPECT_EQ(again.fingerprint(), catalog.fingerprint());
  const auto text = parse_marker_catalog(
      "[markers]\nfamily = \"tag36h11\"\nsize_m = 0.1\ninverted = 1\n", "markers.toml");
  ASSERT_FALSE(text);
  EXPECT_THAT(text.error().message, HasSubstr("line 4"));
}

TEST(MarkerCatalog, AbsentFileIsNoInput) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_marker_catalog(folder.path() / "markers.toml").error().kind, ErrorKind::no_input);
  const auto file = folder.write("markers.toml", "[markers]\nfamily = \"tag16h5\"\nsize_m = 0.1\n");
  EXPECT_EQ(read_marker_catalog(file)->only_family(), Family::tag16h5);
}

}  // namespace
}  // namespace waymark
