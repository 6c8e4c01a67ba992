#include "core/marker/family.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/base/check.h"
#include "core/base/text_field.h"

namespace waymark {
namespace {

using enum Family;

/// By rising family number, so that a family's number is its index.
constexpr std::array<FamilyTraits, 27> kFamilies{{
    {aruco_4x4_50, "aruco_4x4_50", 16, 50, 4},
    {aruco_4x4_100, "aruco_4x4_100", 16, 100, 3},
    {aruco_4x4_250, "aruco_4x4_250", 16, 250, 3},
    {aruco_4x4_1000, "aruco_4x4_1000", 16, 1000, 2},
    {aruco_5x5_50, "aruco_5x5_50", 25, 50, 8},
    {aruco_5x5_100, "aruco_5x5_100", 25, 100, 7},
    {aruco_5x5_250, "aruco_5x5_250", 25, 250, 6},
    {aruco_5x5_1000, "aruco_5x5_1000", 25, 1000, 5},
    {aruco_6x6_50, "aruco_6x6_50", 36, 50, 13},
    {aruco_6x6_100, "aruco_6x6_100", 36, 100, 12},
    {aruco_6x6_250, "aruco_6x6_250", 36, 250, 11},
    {aruco_6x6_1000, "aruco_6x6_1000", 36, 1000, 9},
    {aruco_7x7_50, "aruco_7x7_50", 49, 50, 19},
    {aruco_7x7_100, "aruco_7x7_100", 49, 100, 18},
    {aruco_7x7_250, "aruco_7x7_250", 49, 250, 17},
    {aruco_7x7_1000, "aruco_7x7_1000", 49, 1000, 14},
    {aruco_original, "aruco_original", 25, 1024, 0},  // some look the same upside down
    {tag16h5, "tag16h5", 16, 30, 5},
    {tag25h9, "tag25h9", 25, 35, 9},
    {tag36h10, "tag36h10", 36, 2320, 10},
    {tag36h11, "tag36h11", 36, 587, 11},
    {tagstandard52h13, "tagstandard52h13", 52, 48714, 13},
    {aruco_mip_36h12, "aruco_mip_36h12", 36, 250, 12},
    {tagstandard41h12, "tagStandard41h12", 41, 2115, 12},
    {tagcircle21h7, "tagCircle21h7", 21, 38, 7},
    {tagcircle49h12, "tagCircle49h12", 49, 65535, 12},
    {tagcustom48h12, "tagCustom48h12", 48, 42211, 12},
}};

constexpr bool each_family_stands_at_its_number() {
  for (std::size_t i = 0; i < kFamilies.size(); ++i) {
    if (static_cast<std::size_t>(kFamilies[i].family) != i) return false;
  }
  return true;
}
static_assert(each_family_stands_at_its_number());

}  // namespace

std::span<const FamilyTraits> all_families() { return kFamilies; }

const FamilyTraits& traits(Family family) {
  const auto index = static_cast<std::size_t>(family);
  WAYMARK_CHECK(index < kFamilies.size());
  return kFamilies[index];
}

std::optional<Family> family_from_name(std::string_view name) {
  for (const FamilyTraits& candidate : kFamilies) {
    if (candidate.name == name) return candidate.family;
    const bool mixed_case = candidate.family >= tagstandard52h13;
    if (mixed_case && lower_case(std::string(candidate.name)) == lower_case(std::string(name))) {
      return candidate.family;
    }
  }
  return std::nullopt;
}

std::optional<Family> family_from_number(int number) {
  if (number < 0 || static_cast<std::size_t>(number) >= kFamilies.size()) return std::nullopt;
  return kFamilies[static_cast<std::size_t>(number)].family;
}

}  // namespace waymark
