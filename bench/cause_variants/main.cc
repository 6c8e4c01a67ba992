// The table of variants of bench/results.md: causes in captures as users have them, simulated with
// truth, built by the program's own code.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "bench/cause_variants/faults.h"
#include "core/base/median.h"

namespace {

using namespace waymark;         // NOLINT(google-build-using-namespace): a program
using namespace waymark::bench;  // NOLINT(google-build-using-namespace)

/// A row of the table.
struct Row {
  std::string cause, name;
  int variants = 0, right = 0, wrong = 0, nothing = 0, innocent = 0, exits = 0;
  int values = 0, values_right = 0;
  std::vector<double> cpu_s;

  void count(const Verdict& verdict, double cpu) {
    ++variants;
    right += verdict.told == Verdict::Told::right ? 1 : 0;
    wrong += verdict.told == Verdict::Told::wrong ? 1 : 0;
    nothing += verdict.told == Verdict::Told::nothing ? 1 : 0;
    innocent += verdict.innocent_named ? 1 : 0;
    exits += verdict.exit_right ? 1 : 0;
    values += verdict.value_known ? 1 : 0;
    values_right += verdict.value_right ? 1 : 0;
    cpu_s.push_back(cpu);
  }

  void print() {
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} | {} | {:.2f} |\n", cause, name, variants,
               right, wrong, nothing, innocent,
               values > 0 ? fmt::format("{} of {}", values_right, values) : std::string("–"), exits,
               median(cpu_s));
    std::fflush(stdout);
  }
};

bool is_as_it_should_be(const Verdict& verdict, const Truth& truth) {
  const auto expected = truth.causes.empty() ? Verdict::Told::nothing : Verdict::Told::right;
  return verdict.told == expected && !verdict.innocent_named && verdict.exit_right &&
         (verdict.value_right || !verdict.value_known);
}

void explain(const std::string& name, int number, const Variant& variant, const Said& said,
             std::FILE* file) {
  fmt::print(file, "--- {} {}: {}{}\n", name, number, variant.world().name,
             variant.truth.value ? fmt::format(", {:.4g}", *variant.truth.value) : std::string());
  for (const auto& camera : variant.truth.cameras) fmt::print(file, " {}", camera);
  for (const auto& marker : variant.truth.markers) {
    fmt::print(file, " {}", format_marker_id(marker, false));
  }
  fmt::print(file, "\n{}exit {}\n", said.output, said.exit_code);
  std::fflush(file);
}

}  // namespace

int main(int argc, char** argv) {
  int variants = 20;
  int sound = 200;
  int first = 0;
  std::string only;
  std::string failures;
  std::string keep;
  CLI::App app{"Builds variants of every cause and prints what was told of them."};
  app.add_option("--variants", variants, "of each cause");
  app.add_option("--sound", sound, "sound captures");
  app.add_option("--first", first, "number of the first variant");
  app.add_option("--only", only, "causes or rows whose name contains this");
  app.add_option("--failures", failures, "file for what was said of those that fall");
  app.add_option("--keep", keep, "folder for the last variant's files, which stay there");
  CLI11_PARSE(app, argc, argv);
  std::FILE* file = failures.empty() ? nullptr : std::fopen(failures.c_str(), "w");
  const auto folder = keep.empty() ? std::filesystem::temp_directory_path() /
                                         fmt::format("waymark-variants-{}", ::getpid())
                                   : std::filesystem::path(keep);
  fmt::print(
      "| cause | how | variants | right | wrong cause | nothing | innocent named | value within | "
      "exit right | CPU, s |\n|---|---|---|---|---|---|---|---|---|---|\n");
  const auto run = [&](Row& row, const Variant& variant, int number) {
    const Said said = run_variant(variant, folder);
    const Verdict verdict = judged(said, variant.truth);
    row.count(verdict, said.cpu_s);
    if (file != nullptr && !is_as_it_should_be(verdict, variant.truth)) {
      explain(row.name, number, variant, said, file);
    }
  };
  for (const Fault& fault : all_faults()) {
    Row row{std::string(name_of(fault.cause)), fault.name, 0, 0, 0, 0, 0, 0, 0, 0, {}};
    if (variants <= 0 || (row.cause + " " + row.name).find(only) == std::string::npos) continue;
    for (int i = first; i < first + variants; ++i) run(row, draw_variant(fault, i), i);
    row.print();
  }
  if (std::string("sound").find(only) != std::string::npos && sound > 0) {
    Row row{"–", "sound", 0, 0, 0, 0, 0, 0, 0, 0, {}};
    for (int i = first; i < first + sound; ++i) run(row, draw_sound(i), i);
    row.print();
  }
  for (const NotShown& not_one : not_shown()) {
    fmt::print("not shown by corners: {} ({})\n", name_of(not_one.cause), not_one.why);
  }
  if (file != nullptr) std::fclose(file);
  std::error_code ignored;
  if (keep.empty()) std::filesystem::remove_all(folder, ignored);
  return 0;
}
