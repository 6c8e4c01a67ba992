#include "core/marker/family.h"

#include <array>
#include <cstddef>

#include "core/base/check.h"

namespace waymark {
namespace {

using enum Family;

/// By rising family number, so that a family's number is its index.
constexpr std::array<FamilyTraits, 22> kFamilies{{
    {aruco_4x4_50, "aruco_4x4_50", 4, 50},
    {aruco_4x4_100, "aruco_4x4_100", 4, 100},
    {aruco_4x4_250, "aruco_4x4_250", 4, 250},
    {aruco_4x4_1000, "aruco_4x4_1000", 4, 1000},
    {aruco_5x5_50, "aruco_5x5_50", 5, 50},
    {aruco_5x5_100, "aruco_5x5_100", 5, 100},
    {aruco_5x5_250, "aruco_5x5_250", 5, 250},
    {aruco_5x5_1000, "aruco_5x5_1000", 5, 1000},
    {aruco_6x6_50, "aruco_6x6_50", 6, 50},
    {aruco_6x6_100, "aruco_6x6_100", 6, 100},
    {aruco_6x6_250, "aruco_6x6_250", 6, 250},
    {aruco_6x6_1000, "aruco_6x6_1000", 6, 1000},
    {aruco_7x7_50, "aruco_7x7_50", 7, 50},
    {aruco_7x7_100, "aruco_7x7_100", 7, 100},
    {aruco_7x7_250, "aruco_7x7_250", 7, 250},
    {aruco_7x7_1000, "aruco_7x7_1000", 7, 1000},
    {aruco_original, "aruco_original", 5, 1024},
    {tag16h5, "tag16h5", 4, 30},
    {tag25h9, "tag25h9", 5, 35},
    {tag36h10, "tag36h10", 6, 2320},
    {tag36h11, "tag36h11", 6, 587},
    {tagstandard52h13, "tagstandard52h13", 8, 48714},
}};

/// Those found in images come first.
constexpr std::size_t kFoundInImages = 21;

constexpr bool each_family_stands_at_its_number() {
  for (std::size_t i = 0; i < kFamilies.size(); ++i) {
    if (static_cast<std::size_t>(kFamilies[i].family) != i) return false;
  }
  return true;
}
static_assert(each_family_stands_at_its_number());

}  // namespace

std::span<const FamilyTraits> all_families() {
  return std::span(kFamilies).first<kFoundInImages>();
}

bool is_found_in_images(Family family) { return static_cast<std::size_t>(family) < kFoundInImages; }

const FamilyTraits& traits(Family family) {
  const auto index = static_cast<std::size_t>(family);
  WAYMARK_CHECK(index < kFamilies.size());
  return kFamilies[index];
}

std::optional<Family> family_from_name(std::string_view name) {
  for (const FamilyTraits& candidate : kFamilies) {
    if (candidate.name == name) return candidate.family;
  }
  return std::nullopt;
}

std::optional<Family> family_from_number(int number) {
  if (number < 0 || static_cast<std::size_t>(number) >= kFamilies.size()) return std::nullopt;
  return kFamilies[static_cast<std::size_t>(number)].family;
}

}  // namespace waymark
