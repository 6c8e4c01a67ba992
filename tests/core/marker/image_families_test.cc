#include "core/marker/image_families.h"

#include <gmock/gmock.h>

namespace waymark {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

MarkerCatalog catalog_of(const std::vector<Family>& families) {
  std::vector<MarkerCatalog::FamilyEntry> entries;
  for (const Family family : families) entries.push_back({family, 0.2, {}, {}});
  return MarkerCatalog(entries);
}

TEST(ImageFamilies, AreThoseThatDetectorsKnow) {
  EXPECT_THAT(families_in_images(catalog_of({Family::tag36h11, Family::tagstandard52h13})),
              ElementsAre(Family::tag36h11));
  EXPECT_THAT(families_in_images(catalog_of({Family::tagstandard52h13})), IsEmpty());
}

TEST(ImageFamilies, WhatImagesNeverShowIsSaidAndNothingElseIsRefused) {
  const auto all = shown_in_images(catalog_of({Family::tag36h11}), "hall.map");
  ASSERT_TRUE(all);
  EXPECT_FALSE(all->has_value());
  const auto some =
      shown_in_images(catalog_of({Family::tag36h11, Family::tagstandard52h13}), "hall.map");
  ASSERT_TRUE(some) << some.error().message;
  EXPECT_THAT(some->value(), AllOf(HasSubstr("hall.map: "), HasSubstr("tagstandard52h13")));
  const auto none = shown_in_images(catalog_of({Family::tagstandard52h13}), "hall.map");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(none.error().message,
              AllOf(HasSubstr("hall.map: "), HasSubstr("can't be found in images")));
}

}  // namespace
}  // namespace waymark
