#include "core/marker/nested_families.h"

namespace waymark {
namespace {

/// Four sizes of each, by rising family number.
constexpr int kSizes = 4;

bool is_nested(Family family) { return family <= Family::aruco_7x7_1000; }

int first_of_its_size(Family family) { return static_cast<int>(family) / kSizes * kSizes; }

}  // namespace

Family largest_beginning_with(Family family) {
  if (!is_nested(family)) return family;
  return static_cast<Family>(first_of_its_size(family) + kSizes - 1);
}

Family smallest_holding(Family largest, int number) {
  if (!is_nested(largest)) return largest;
  int family = first_of_its_size(largest);
  while (family < static_cast<int>(largest) &&
         traits(static_cast<Family>(family)).id_count <= number) {
    ++family;
  }
  return static_cast<Family>(family);
}

}  // namespace waymark
