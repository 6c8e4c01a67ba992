#include "mapbuilder/commands/print_command.h"

#include <fmt/ostream.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/atomic_file.h"
#include "core/base/is_there.h"
#include "core/base/notes.h"
#include "core/base/output_check.h"
#include "core/base/range.h"
#include "core/base/same_file.h"
#include "core/camera/kalibr.h"
#include "core/marker/id_range.h"
#include "core/marker/marker_catalog.h"
#include "core/marker/marker_layout.h"
#include "core/marker/nested_families.h"
#include "mapbuilder/commands/print_line.h"
#include "mapbuilder/print/pdf_file.h"
#include "mapbuilder/print/print_advice.h"
#include "mapbuilder/print/sheet_layout.h"

namespace waymark {
namespace {

constexpr Range kPrintedSize_m{0.005, 5};

Expected<Family> family_named(const std::string& name) {
  const auto family = family_from_name(name);
  if (family) return *family;
  std::vector<std::string_view> names;
  for (const FamilyTraits& known : all_families()) {
    names.push_back(known.name);
  }
  return fail(ErrorKind::usage, "--family {}: can't be printed; it is one of {}", name,
              fmt::join(names, ", "));
}

/// The ids of one batch. Each is named once in all, so that a family bounds how many there are.
Expected<std::vector<int>> numbers_of(const std::string& ids, Family family, double size_m,
                                      std::map<MarkerId, double>& named) {
  const auto ranges = parse_id_ranges(ids, family);
  if (!ranges) return fail(ErrorKind::usage, "--ids {}: {}", ids, ranges.error().message);
  std::vector<int> numbers;
  for (const IdRange& range : *ranges) {
    for (int id = range.first; id <= range.last; ++id) {
      const auto [known, is_new] = named.emplace(MarkerId{family, id}, size_m);
      if (!is_new && known->second != size_m) {
        return fail(ErrorKind::usage, "--ids: {} {} would have two sizes, {} and {} m",
                    name_of(family), id, known->second, size_m);
      }
      if (!is_new) {
        return fail(ErrorKind::usage, "--ids: {} {} is named twice", name_of(family), id);
      }
      numbers.push_back(id);
    }
  }
  return numbers;
}

/// The k-th of values that are given once for all, or once each.
template <typename Value>
const Value& of_batch(const std::vector<Value>& values, std::size_t k) {
  return values.size() == 1 ? values.front() : values[k];
}

Expected<std::vector<MarkerBatch>> batches_of(const PrintOptions& options) {
  const std::size_t count = options.ids.size();
  const auto fits = [&](std::size_t values) { return values == 1 || values == count; };
  if (count == 0 || !fits(options.families.size()) || !fits(options.sizes_m.size())) {
    return fail(ErrorKind::usage,
                "print: give --ids, and --family and --size-m once for all or as often as --ids");
  }
  std::vector<MarkerBatch> batches;
  std::map<MarkerId, double> named;
  for (std::size_t k = 0; k < count; ++k) {
    const auto family = family_named(of_batch(options.families, k));
    if (!family) return tl::make_unexpected(family.error());
    const double size_m = of_batch(options.sizes_m, k);
    for (const MarkerBatch& other : batches) {
      if (other.family == *family || !share_codes(other.family, *family)) continue;
      return fail(ErrorKind::usage,
                  "--family: {} and {} have codes in common, and one would mean two ids; print one",
                  name_of(other.family), name_of(*family));
    }
    if (!kPrintedSize_m.contains(size_m)) {
      return fail(ErrorKind::usage, "--size-m {}: must lie within {} and {} m", size_m,
                  kPrintedSize_m.low, kPrintedSize_m.high);
    }
    auto numbers = numbers_of(options.ids[k], *family, size_m, named);
    if (!numbers) return tl::make_unexpected(numbers.error());
    batches.push_back({*family, std::move(*numbers), size_m});
  }
  return batches;
}

/// markers.toml of what is printed.
MarkerCatalog catalog_of(const std::vector<MarkerBatch>& batches) {
  std::vector<MarkerCatalog::FamilyEntry> entries;
  for (const MarkerBatch& batch : batches) {
    auto entry = std::find_if(entries.begin(), entries.end(),
                              [&](const auto& one) { return one.family == batch.family; });
    if (entry == entries.end()) {
      entries.push_back({batch.family, {}, {}, {}});
      entry = entries.end() - 1;
    }
    for (const int number : batch.numbers) entry->size_m_by_id.emplace(number, batch.size_m);
  }
  return MarkerCatalog(std::move(entries));
}

/// The size that a markers.toml states for a marker, before its print_scale.
std::optional<double> stated_size_m(const MarkerCatalog& catalog, const MarkerId& id) {
  const auto size_m = catalog.size_m(id);
  if (!size_m) return std::nullopt;
  const auto entry =
      std::find_if(catalog.entries().begin(), catalog.entries().end(),
                   [&](const MarkerCatalog::FamilyEntry& one) { return one.family == id.family; });
  return *size_m / entry->print_scale;
}

/// Whether a markers.toml that is there states what is printed.
Status check_states(const MarkerCatalog& there, const std::filesystem::path& path,
                    const std::vector<MarkerBatch>& batches) {
  for (const MarkerBatch& batch : batches) {
    if (there.shows_light_squares(batch.family) != marker_layout(batch.family).is_light()) {
      return fail(ErrorKind::bad_data,
                  "{}: states {} as inverted, and sheets are printed as the family is; name a file "
                  "in another folder",
                  path.string(), name_of(batch.family));
    }
    for (const int number : batch.numbers) {
      const auto size_m = stated_size_m(there, {batch.family, number});
      constexpr double kRounding = 1e-9;
      if (size_m && std::abs(*size_m / batch.size_m - 1) < kRounding) continue;
      return fail(
          ErrorKind::bad_data,
          "{}: states {} for {} {}, and {} m is to be printed; correct it, or name a file in "
          "another folder",
          path.string(), size_m ? fmt::format("{} m", *size_m) : "no size", name_of(batch.family),
          number, batch.size_m);
    }
  }
  return {};
}

}  // namespace

Status run_print(const PrintOptions& options, std::ostream& out) {
  const auto paper = paper_from_name(options.paper);
  if (!paper) return tl::make_unexpected(paper.error());
  const auto batches = batches_of(options);
  if (!batches) return tl::make_unexpected(batches.error());
  const MarkerCatalog catalog = catalog_of(*batches);
  if (auto writable = check_writable(options.output); !writable) return writable;
  const auto markers_toml = options.output.parent_path() / "markers.toml";
  if (is_same_file(options.output, markers_toml)) {
    return fail(ErrorKind::usage, "-o {}: name a PDF; markers.toml is written beside it",
                options.output.string());
  }
  const bool there = is_there(markers_toml);
  if (there) {
    const auto stated = read_marker_catalog(markers_toml);
    if (!stated) return tl::make_unexpected(stated.error());
    if (auto states = check_states(*stated, markers_toml, *batches); !states) return states;
  }
  const auto sheets = lay_out(*batches, *paper);
  if (!sheets) return tl::make_unexpected(sheets.error());
  const auto pdf = pdf_of(*sheets);
  if (!pdf) return tl::make_unexpected(pdf.error());
  // Sizes without their sheets can be taken back, sheets without sizes are lost on a full disk.
  if (!there) {
    const std::string text =
        "# Sizes are the black squares' outer edges (m) as printed. Where the ruler of a sheet is "
        "not "
        "as long\n# as it says, state what it measures by what it should beside the family, such "
        "as "
        "print_scale = 0.985.\n" +
        format_marker_catalog(catalog);
    if (auto written = write_file_atomically(markers_toml, text); !written) return written;
  }
  if (auto written = write_file_atomically(options.output, *pdf); !written) {
    std::error_code ignored;
    if (!there) std::filesystem::remove(markers_toml, ignored);
    return written;
  }
  std::size_t markers = 0;
  for (const MarkerBatch& batch : *batches) markers += batch.numbers.size();
  print_line(out, "{}: {} markers on {} sheets; sizes: {}{}", options.output.string(), markers,
             sheets->size(), markers_toml.string(), there ? " (as it was)" : "");
  fmt::print(out, "print at 100 %, not \"fit to page\", and measure a ruler\n");
  return {};
}

Status run_print_advice(const PrintAdviceOptions& options, std::ostream& out, std::ostream& notes) {
  if (options.rig.empty())
    return fail(ErrorKind::usage, "print --advise: --rig RIG.yaml is required");
  if (!options.range_m) {
    return fail(ErrorKind::usage,
                "print --advise: --range-m, the farthest a marker is read, is "
                "required");
  }
  if (!kAdviceRange_m.contains(*options.range_m)) {
    return fail(ErrorKind::usage, "--range-m {}: must lie within {} and {} m", *options.range_m,
                kAdviceRange_m.low, kAdviceRange_m.high);
  }
  const auto rig = read_camchain(options.rig);
  if (!rig) return tl::make_unexpected(rig.error());
  for (const std::string& note : shown_notes(rig->notes)) {
    fmt::print(notes, "{}\n", note_line(note));
  }
  fmt::print(out, "{}", advice_text(print_advice(rig->rig, *options.range_m), *options.range_m));
  return {};
}

}  // namespace waymark
