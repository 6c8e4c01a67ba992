// What looking a quad's cells up takes: random cells, which no table holds as a rule and which take
// longest, and markers with as many wrong bits as are corrected. One thread, its processor time.
// Usage: bench_code_tables

#include <fmt/core.h>

#include <chrono>
#include <ctime>
#include <random>

#include "core/detect/code_table.h"
#include "core/marker/marker_codes.h"

namespace {

using namespace waymark;  // NOLINT(google-build-using-namespace): a program of one file

double thread_seconds() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

constexpr int kLooks = 20'000;

/// ns for each of the codes.
double look_up(const CodeTable& table, const MarkerLayout& layout,
               const std::vector<std::uint64_t>& codes) {
  std::vector<CodeMatch> matches;
  matches.reserve(64);
  const double begin = thread_seconds();
  for (const std::uint64_t code : codes) {
    matches.clear();
    table.find(layout, code, matches);
  }
  return 1e9 * (thread_seconds() - begin) / static_cast<double>(codes.size());
}

std::vector<std::uint64_t> random_cells(int bits) {
  std::mt19937_64 random(7);
  std::vector<std::uint64_t> codes(kLooks);
  for (std::uint64_t& code : codes) code = random() >> (64 - bits);
  return codes;
}

std::vector<std::uint64_t> markers(const FamilyTraits& family, int wrong) {
  std::mt19937_64 random(7);
  std::vector<std::uint64_t> codes(kLooks);
  for (std::uint64_t& code : codes) {
    const auto number = static_cast<int>(random() % static_cast<unsigned>(family.id_count));
    code = marker_code({family.family, number});
    for (int i = 0; i < wrong; ++i) {
      code ^= std::uint64_t{1} << random() % static_cast<unsigned>(family.code_bits);
    }
  }
  return codes;
}

void one_family(const FamilyTraits& family) {
  const CodeTable table({&family.family, 1});
  const MarkerLayout& layout = marker_layout(family.family);
  const int corrected = correctable_bits(family.family);
  fmt::print("| {:<16} | {:5} | {} of {} | {:6.0f} | {:6.0f} | {:6.0f} |\n", family.name,
             family.id_count, corrected, (std::max(1, family.distance) - 1) / 2,
             look_up(table, layout, random_cells(family.code_bits)),
             look_up(table, layout, markers(family, 0)),
             look_up(table, layout, markers(family, corrected)));
}

/// A quad's cells are read once for each layout and looked up in the families that have it.
void all_together() {
  std::vector<Family> families;
  for (const FamilyTraits& family : all_families()) families.push_back(family.family);
  const CodeTable table(families);
  double dark = 0;
  double light = 0;
  for (const MarkerLayout* const layout : table.layouts()) {
    const double ns =
        look_up(table, *layout, random_cells(static_cast<int>(layout->code().size())));
    (layout->is_light() ? light : dark) += ns;
  }
  fmt::print("all {} families: {:.0f} ns a dark quad, {:.0f} ns a light one\n", families.size(),
             dark, light);
}

}  // namespace

int main() {
  fmt::print(
      "| family | ids | corrected | ns, random cells | a marker | with all its wrong bits |\n");
  for (const FamilyTraits& family : all_families()) one_family(family);
  all_together();
}
