#include "core/detect/code_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <mutex>

#include "core/base/check.h"
#include "core/marker/marker_codes.h"

namespace waymark {
namespace {

/// Ways to choose up to `most` of `all`.
double choices_up_to(int most, int all) {
  double sum = 1;
  double choices = 1;
  for (int i = 1; i <= most; ++i) {
    choices *= static_cast<double>(all - i + 1) / i;
    sum += choices;
  }
  return sum;
}

/// Chance that random cells read as some marker of the family, any way up, with up to `corrected`
/// wrong bits.
double random_acceptance(const FamilyTraits& family, int corrected) {
  return 4.0 * family.id_count * choices_up_to(corrected, family.code_bits) /
         std::exp2(family.code_bits);
}

/// For each cell of the code the one that is seen in its place when the next corner is taken for
/// the first, which is the top left's: a marker whose top left is the corner before.
std::vector<int> seen_from_next_corner(const MarkerLayout& layout) {
  std::vector<int> seen;
  for (const CellPlace& cell : layout.code()) {
    const CellPlace there{cell.column, layout.square_cells() - 1 - cell.row};
    const auto found = std::find(layout.code().begin(), layout.code().end(), there);
    WAYMARK_CHECK(found != layout.code().end());
    seen.push_back(static_cast<int>(found - layout.code().begin()));
  }
  return seen;
}

std::uint64_t turned(std::uint64_t code, const std::vector<int>& seen) {
  std::uint64_t result = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) result |= (code >> seen[i] & 1U) << i;
  return result;
}

/// By number · 4 + k: as seen from the k-th corner before its own top left.
std::vector<std::uint64_t> all_turns(Family family) {
  const std::vector<int> seen = seen_from_next_corner(marker_layout(family));
  std::vector<std::uint64_t> codes(4 * static_cast<std::size_t>(traits(family).id_count));
  for (std::size_t number = 0; 4 * number < codes.size(); ++number) {
    std::uint64_t code = marker_code({family, static_cast<int>(number)});
    for (std::size_t k = 0; k < 4; ++k, code = turned(code, seen)) codes[4 * number + k] = code;
  }
  return codes;
}

/// Flipped bits of each of `count` pieces, such that Σ (flipped + 1) = corrected + 1.
int flipped_in(int piece, int count, int corrected) {
  return (corrected + 1) / count + (piece < (corrected + 1) % count ? 1 : 0) - 1;
}

int length_of(int piece, int count, int bits) {
  return bits * (piece + 1) / count - bits * piece / count;
}

/// Buckets and codes that are looked at in `count` pieces.
double looks(int count, int corrected, int bits, double codes) {
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    const int length = length_of(i, count, bits);
    sum += choices_up_to(flipped_in(i, count, corrected), length) * (1 + codes / std::exp2(length));
  }
  return sum;
}

int best_count(int corrected, int bits, std::size_t codes) {
  int best = 1;
  for (int count = 2; count <= corrected + 1; ++count) {
    const auto all = static_cast<double>(codes);
    if (looks(count, corrected, bits, all) < looks(best, corrected, bits, all)) best = count;
  }
  return best;
}

/// Bits in which two codes differ; the processors that this is built for need not count bits.
int differing_bits(std::uint64_t a, std::uint64_t b) {
  std::uint64_t x = a ^ b;
  x -= x >> 1 & 0x5555555555555555U;
  x = (x & 0x3333333333333333U) + (x >> 2 & 0x3333333333333333U);
  x = (x + (x >> 4)) & 0x0F0F0F0F0F0F0F0FU;
  return static_cast<int>(x * 0x0101010101010101U >> 56);
}

}  // namespace

int correctable_bits(Family family) {
  constexpr double kMaxRandomAcceptance = 1e-3;
  const FamilyTraits& all = traits(family);
  int corrected = std::max(0, (all.distance - 1) / 2);
  while (corrected > 0 && random_acceptance(all, corrected) > kMaxRandomAcceptance) --corrected;
  return corrected;
}

/// The nearest code so far; of equally near ones the first by number and turn.
struct CodeTable::Nearest {
  int wrong_bits;
  std::uint32_t place = 0;
  bool any = false;
};

std::uint64_t CodeTable::Piece::value_in(std::uint64_t code) const {
  return code << (64 - first - length) >> (64 - length);
}

std::size_t CodeTable::Piece::bucket(std::uint64_t value) const {
  constexpr std::uint64_t kGolden = 0x9E3779B97F4A7C15U;  // 2⁶⁴ / the golden ratio
  return static_cast<std::size_t>(value * kGolden >> (64 - std::countr_zero(ends.size())));
}

void CodeTable::Piece::fill(std::span<const std::uint64_t> turned) {
  const auto bucket_of = [&](std::uint64_t code) { return bucket(value_in(code)); };
  ends.assign(std::max<std::size_t>(2, std::bit_ceil(turned.size())), 0);
  for (const std::uint64_t code : turned) ++ends[bucket_of(code)];
  std::uint32_t end = 0;
  for (std::uint32_t& bucket_end : ends) bucket_end = end += bucket_end;
  std::vector<std::uint32_t> next = ends;
  codes.resize(turned.size());
  places.resize(turned.size());
  for (std::size_t place = turned.size(); place-- > 0;) {
    const std::uint32_t slot = --next[bucket_of(turned[place])];
    codes[slot] = turned[place];
    places[slot] = static_cast<std::uint32_t>(place);
  }
}

CodeTable::Codes CodeTable::codes_of(Family family) {
  Codes codes{family, &marker_layout(family), correctable_bits(family), {}};
  const std::vector<std::uint64_t> turned = all_turns(family);
  const int bits = traits(family).code_bits;
  const int count = best_count(codes.corrected, bits, turned.size());
  for (int i = 0; i < count; ++i) {
    Piece piece;
    piece.first = bits * i / count;
    piece.length = length_of(i, count, bits);
    piece.flipped = flipped_in(i, count, codes.corrected);
    piece.fill(turned);
    codes.pieces.push_back(std::move(piece));
  }
  return codes;
}

/// A family of 50,000 ids takes 10 MB: once, however many cameras look for it.
std::shared_ptr<const CodeTable::Codes> CodeTable::shared_codes(Family family) {
  static std::mutex mutex;
  static std::map<Family, std::weak_ptr<const Codes>> made;
  const std::lock_guard lock(mutex);
  std::shared_ptr<const Codes> codes = made[family].lock();
  if (!codes) {
    codes = std::make_shared<const Codes>(codes_of(family));
    made[family] = codes;
  }
  return codes;
}

CodeTable::CodeTable(std::span<const Family> families) {
  for (const Family family : families) {
    families_.push_back(shared_codes(family));
    const MarkerLayout* const layout = families_.back()->layout;
    const bool known = std::any_of(layouts_.begin(), layouts_.end(),
                                   [&](const MarkerLayout* one) { return *one == *layout; });
    if (!known) layouts_.push_back(layout);
  }
}

/// Looks at the codes whose piece has the value, and with up to `flips` of its bits from `from` on
/// flipped, until one is found.
void CodeTable::look(const Piece& piece, std::uint64_t code, std::uint64_t value, int from,
                     int flips, Nearest& nearest) {
  const std::size_t bucket = piece.bucket(value);
  for (std::uint32_t i = bucket > 0 ? piece.ends[bucket - 1] : 0; i < piece.ends[bucket]; ++i) {
    const int wrong = differing_bits(piece.codes[i], code);
    if (wrong > nearest.wrong_bits) continue;
    if (nearest.any && wrong == nearest.wrong_bits && piece.places[i] >= nearest.place) continue;
    nearest = {wrong, piece.places[i], true};
  }
  if (flips == 0) return;
  for (int bit = from; bit < piece.length && !nearest.any; ++bit) {
    look(piece, code, value ^ std::uint64_t{1} << bit, bit + 1, flips - 1, nearest);
  }
}

void CodeTable::find(const MarkerLayout& layout, std::uint64_t code,
                     std::vector<CodeMatch>& matches) const {
  for (const auto& family : families_) {
    if (family->layout != &layout && *family->layout != layout) continue;
    Nearest nearest{family->corrected};
    // No two codes are both near enough: the first that is found is the nearest. Most markers have
    // a piece without wrong bits.
    for (const bool with_flips : {false, true}) {
      for (const Piece& piece : family->pieces) {
        if (nearest.any) break;
        const int flips = with_flips ? piece.flipped : 0;
        look(piece, code, piece.value_in(code), 0, flips, nearest);
      }
    }
    if (!nearest.any) continue;
    const auto number = static_cast<int>(nearest.place / 4);
    const auto turn = static_cast<int>((4 - nearest.place % 4) % 4);
    matches.push_back({{family->family, number}, nearest.wrong_bits, turn});
  }
}

}  // namespace waymark
