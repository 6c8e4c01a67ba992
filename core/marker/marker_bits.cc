#include "core/marker/marker_bits.h"

#include "core/marker/marker_codes.h"

namespace waymark {

MarkerBits marker_bits(const MarkerId& id) {
  const MarkerLayout& layout = marker_layout(id.family);
  MarkerBits bits;
  bits.layout = &layout;
  bits.cells = layout.square_cells();
  bits.outside = layout.outside_cells();
  std::uint64_t code = marker_code(id);
  const int end = bits.cells + bits.outside;
  for (int row = -bits.outside; row < end; ++row) {
    for (int column = -bits.outside; column < end; ++column) {
      const CellKind kind = layout.at({row, column});
      const bool is_code = kind == CellKind::code;
      const bool white = kind == CellKind::white || (is_code && (code & 1U) != 0);
      bits.white[bits.index(row, column)] = white ? 1 : 0;
      if (is_code) code >>= 1;
    }
  }
  return bits;
}

MarkerBits negative_of(MarkerBits bits) {
  const auto count = static_cast<std::size_t>(bits.all_cells() * bits.all_cells());
  for (std::size_t i = 0; i < count; ++i) bits.white[i] = bits.white[i] == 0 ? 1 : 0;
  return bits;
}

}  // namespace waymark
