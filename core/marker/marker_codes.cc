#include "core/marker/marker_codes.h"

#include <array>
#include <cstddef>

#include "core/base/check.h"
#include "core/marker/nested_families.h"

// A file's bytes as a constant of that name. The assembler reads it, which takes no time for a
// megabyte; CMakeLists.txt has it look in codes/.
#define WAYMARK_CODES(name)                                           \
  extern "C" const std::uint8_t waymark_codes_##name[];               \
  asm(".pushsection .rodata\n"                                        \
      ".global waymark_codes_" #name "\n.hidden waymark_codes_" #name \
      "\n"                                                            \
      "waymark_codes_" #name ":\n.incbin \"" #name ".bin\"\n.popsection\n")

WAYMARK_CODES(aruco_4x4_1000);
WAYMARK_CODES(aruco_5x5_1000);
WAYMARK_CODES(aruco_6x6_1000);
WAYMARK_CODES(aruco_7x7_1000);
WAYMARK_CODES(aruco_original);
WAYMARK_CODES(tag16h5);
WAYMARK_CODES(tag25h9);
WAYMARK_CODES(tag36h10);
WAYMARK_CODES(tag36h11);
WAYMARK_CODES(tagstandard52h13);
WAYMARK_CODES(aruco_mip_36h12);
WAYMARK_CODES(tagstandard41h12);
WAYMARK_CODES(tagcircle21h7);
WAYMARK_CODES(tagcircle49h12);
WAYMARK_CODES(tagcustom48h12);

namespace waymark {
namespace {

/// Of a family that no other begins with.
const std::uint8_t* table_of(Family family) {
  switch (family) {
    case Family::aruco_4x4_1000:
      return waymark_codes_aruco_4x4_1000;
    case Family::aruco_5x5_1000:
      return waymark_codes_aruco_5x5_1000;
    case Family::aruco_6x6_1000:
      return waymark_codes_aruco_6x6_1000;
    case Family::aruco_7x7_1000:
      return waymark_codes_aruco_7x7_1000;
    case Family::aruco_original:
      return waymark_codes_aruco_original;
    case Family::tag16h5:
      return waymark_codes_tag16h5;
    case Family::tag25h9:
      return waymark_codes_tag25h9;
    case Family::tag36h10:
      return waymark_codes_tag36h10;
    case Family::tag36h11:
      return waymark_codes_tag36h11;
    case Family::tagstandard52h13:
      return waymark_codes_tagstandard52h13;
    case Family::aruco_mip_36h12:
      return waymark_codes_aruco_mip_36h12;
    case Family::tagstandard41h12:
      return waymark_codes_tagstandard41h12;
    case Family::tagcircle21h7:
      return waymark_codes_tagcircle21h7;
    case Family::tagcircle49h12:
      return waymark_codes_tagcircle49h12;
    case Family::tagcustom48h12:
      return waymark_codes_tagcustom48h12;
    default:
      break;
  }
  WAYMARK_CHECK(false);
  return nullptr;
}

}  // namespace

std::uint64_t marker_code(const MarkerId& id) {
  const FamilyTraits& family = traits(id.family);
  WAYMARK_CHECK(id.number >= 0 && id.number < family.id_count);
  const int bytes = (family.code_bits + 7) / 8;
  const std::uint8_t* const code =
      table_of(largest_beginning_with(id.family)) + std::ptrdiff_t{bytes} * id.number;
  std::uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value |= std::uint64_t{code[i]} << (8 * i);
  return value;
}

}  // namespace waymark
