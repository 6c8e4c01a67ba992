#include "core/marker/family.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace waymark {
namespace {

TEST(Family, NamesAndNumbersLeadBackToTheFamily) {
  std::set<std::string> names;
  for (const FamilyTraits& family : all_families()) {
    EXPECT_EQ(&traits(family.family), &family);
    EXPECT_EQ(family_from_name(family.name), family.family);
    EXPECT_EQ(family_from_number(static_cast<int>(family.family)), family.family);
    names.emplace(family.name);
  }
  EXPECT_EQ(names.size(), 27U);
}

TEST(Family, NamesAreThoseOfMarkersToml) {
  EXPECT_EQ(name_of(Family::aruco_4x4_1000), "aruco_4x4_1000");
  EXPECT_EQ(name_of(Family::aruco_original), "aruco_original");
  EXPECT_EQ(name_of(Family::tag36h11), "tag36h11");
}

TEST(Family, AprilTagsLaterNamesAreTakenInAnyCase) {
  for (const char* name : {"tagstandard52h13", "tagStandard52h13"}) {
    EXPECT_EQ(family_from_name(name), Family::tagstandard52h13);
  }
  for (const char* name : {"tagcircle21h7", "tagCircle21h7"}) {
    EXPECT_EQ(family_from_name(name), Family::tagcircle21h7);
  }
}

TEST(Family, UnknownNamesAndNumbersAreNone) {
  for (const char* name : {"", "aruco", "aruco_4x4", "TAG36H11", "tag36h11 ", "aruco_8x8_50"}) {
    EXPECT_FALSE(family_from_name(name)) << name;
  }
  EXPECT_FALSE(family_from_number(-1));
  EXPECT_FALSE(family_from_number(27));
}

TEST(Family, NumbersInMapFilesNeverChange) {
  EXPECT_EQ(family_from_number(0), Family::aruco_4x4_50);
  EXPECT_EQ(family_from_number(3), Family::aruco_4x4_1000);
  EXPECT_EQ(family_from_number(16), Family::aruco_original);
  EXPECT_EQ(family_from_number(20), Family::tag36h11);
  EXPECT_EQ(family_from_number(21), Family::tagstandard52h13);
  EXPECT_EQ(family_from_number(22), Family::aruco_mip_36h12);
  EXPECT_EQ(family_from_number(26), Family::tagcustom48h12);
}

TEST(MeetingFamilies, AreSeveralOrOneOrNone) {
  MeetingFamilies families;
  EXPECT_FALSE(families.several());
  EXPECT_FALSE(families.only());
  for (int i = 0; i < 2; ++i) families.add(Family::tag36h11);
  EXPECT_FALSE(families.several());
  EXPECT_EQ(families.only(), Family::tag36h11);
  families.add(Family::tag25h9);
  families.add(Family::tag36h11);
  EXPECT_TRUE(families.several());
  EXPECT_FALSE(families.only());
}

}  // namespace
}  // namespace waymark
