#include "core/detect/code_table.h"

#include <algorithm>
#include <bit>

#include "core/base/check.h"
#include "core/detect/aruco_detector.h"
#include "core/marker/marker_bits.h"

namespace waymark {
namespace {

std::uint64_t upright_code(const MarkerId& id, int cells) {
  const MarkerBits bits = marker_bits(id);
  std::uint64_t code = 0;
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      if (bits.is_white(row + 1, column + 1)) code |= std::uint64_t{1} << (row * cells + column);
    }
  }
  return code;
}

/// What the code shows to whom the next corner is the first.
std::uint64_t from_next_corner(std::uint64_t code, int cells) {
  std::uint64_t turned = 0;
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      const int seen = column * cells + cells - 1 - row;
      turned |= (code >> seen & 1U) << (row * cells + column);
    }
  }
  return turned;
}

}  // namespace

std::size_t CodeTable::Piece::bucket(std::uint64_t code) const {
  constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15U;  // 2⁶⁴ / the golden ratio
  const std::uint64_t value = code << (64 - first - length) >> (64 - length);
  return static_cast<std::size_t>(value * kGolden >> (64 - std::countr_zero(ends.size())));
}

CodeTable::Codes CodeTable::codes_of(Family family) {
  WAYMARK_CHECK(is_found_in_images(family));
  Codes codes{family, traits(family).code_cells, correctable_bits(family), {}, {}};
  for (int number = 0; number < traits(family).id_count; ++number) {
    std::uint64_t code = upright_code({family, number}, codes.code_cells);
    // A marker whose top left is the quad's corner `turn` shows itself from the corners before.
    for (int turn = 4; turn > 0; --turn) {
      codes.turned.push_back({code, number, turn % 4});
      code = from_next_corner(code, codes.code_cells);
    }
  }
  sort_into_pieces(codes);
  return codes;
}

void CodeTable::sort_into_pieces(Codes& codes) {
  const int bits = codes.code_cells * codes.code_cells;
  const int count = codes.corrected + 1;
  for (int i = 0; i < count; ++i) {
    Piece piece;
    piece.first = bits * i / count;
    piece.length = bits * (i + 1) / count - piece.first;
    piece.ends.assign(std::bit_ceil(codes.turned.size()), 0);
    for (const Turned& one : codes.turned) ++piece.ends[piece.bucket(one.code)];
    std::uint32_t end = 0;
    for (std::uint32_t& bucket_end : piece.ends) bucket_end = end += bucket_end;
    piece.sorted.resize(codes.turned.size());
    std::vector<std::uint32_t> next = piece.ends;
    for (std::size_t k = codes.turned.size(); k-- > 0;) {
      piece.sorted[--next[piece.bucket(codes.turned[k].code)]] = static_cast<std::uint32_t>(k);
    }
    codes.pieces.push_back(std::move(piece));
  }
}

CodeTable::CodeTable(std::span<const Family> families) {
  for (const Family family : families) {
    families_.push_back(codes_of(family));
    sizes_.push_back(families_.back().code_cells);
  }
  std::sort(sizes_.begin(), sizes_.end());
  sizes_.erase(std::unique(sizes_.begin(), sizes_.end()), sizes_.end());
}

void CodeTable::find(int code_cells, std::uint64_t code, std::vector<CodeMatch>& matches) const {
  for (const Codes& family : families_) {
    if (family.code_cells != code_cells) continue;
    const Turned* nearest = nullptr;
    int fewest = family.corrected + 1;
    for (const Piece& piece : family.pieces) {
      const std::size_t bucket = piece.bucket(code);
      for (std::uint32_t i = bucket > 0 ? piece.ends[bucket - 1] : 0; i < piece.ends[bucket]; ++i) {
        const Turned& candidate = family.turned[piece.sorted[i]];
        const int wrong = std::popcount(candidate.code ^ code);
        if (wrong >= fewest) continue;
        fewest = wrong;
        nearest = &candidate;
      }
    }
    if (nearest == nullptr) continue;
    matches.push_back({{family.family, nearest->number}, fewest, nearest->turn});
  }
}

}  // namespace waymark
