#include "core/marker/marker_catalog.h"

#include <xxhash.h>

#include <algorithm>
#include <cmath>

#include "core/base/one_line.h"
#include "core/base/toml_text.h"
#include "core/marker/id_range.h"
#include "core/marker/marker_layout.h"
#include "core/marker/nested_families.h"

namespace waymark {
namespace {

/// Nobody prints larger markers; a larger number is one in mm.
constexpr double kMaxSize_m = 100.0;

/// Reads one catalog; `name` stands for the path in messages.
class CatalogReader {
 public:
  explicit CatalogReader(const std::string& name) : name_(name) {}

  Expected<MarkerCatalog> read(const toml::table& root) const {
    if (const auto status = check_toml_keys(root, {"markers"}, name_); !status) {
      return tl::make_unexpected(status.error());
    }
    const toml::node* const markers = root.get("markers");
    std::vector<const toml::table*> blocks;
    if (markers != nullptr && markers->is_table()) blocks.push_back(markers->as_table());
    if (markers != nullptr && markers->is_array_of_tables()) {
      for (const toml::node& block : *markers->as_array()) blocks.push_back(block.as_table());
    }
    if (blocks.empty()) {
      return fail(ErrorKind::bad_data,
                  "{}: no [markers] block; it states the family and the size_m", name_);
    }
    std::vector<MarkerCatalog::FamilyEntry> entries;
    for (const toml::table* block : blocks) {
      auto entry = read_block(*block);
      if (!entry) return tl::make_unexpected(entry.error());
      const auto same_family = [&](const auto& earlier) { return earlier.family == entry->family; };
      if (std::any_of(entries.begin(), entries.end(), same_family)) {
        return fail(ErrorKind::bad_data, "{}: family \"{}\" has two blocks; join them",
                    toml_place(name_, *block), name_of(entry->family));
      }
      const auto nested = std::find_if(entries.begin(), entries.end(), [&](const auto& earlier) {
        return share_codes(earlier.family, entry->family);
      });
      if (nested != entries.end()) {
        const auto [smaller, larger] = std::minmax(nested->family, entry->family);
        return fail(Cause::family,
                    "{}: {} is the beginning of {}: every code would mean two ids; list one",
                    toml_place(name_, *block), name_of(smaller), name_of(larger));
      }
      entries.push_back(std::move(*entry));
    }
    return MarkerCatalog(std::move(entries));
  }

 private:
  using FamilyEntry = MarkerCatalog::FamilyEntry;

  Expected<FamilyEntry> read_block(const toml::table& block) const {
    if (const auto status = check_toml_keys(
            block,
            {"family", "print_scale", "size_m", "size_sigma_m", "ignore", "sizes", "inverted"},
            name_);
        !status) {
      return tl::make_unexpected(status.error());
    }
    const auto family = read_family(block);
    if (!family) return tl::make_unexpected(family.error());
    FamilyEntry entry;
    entry.family = *family;
    if (const toml::node* size = block.get("size_m")) {
      const auto size_m = read_size(*size);
      if (!size_m) return tl::make_unexpected(size_m.error());
      entry.default_size_m = *size_m;
    }
    const auto sigma = read_size_sigma(block, entry.default_size_m);
    if (!sigma) return tl::make_unexpected(sigma.error());
    entry.default_size_sigma_m = *sigma;
    if (const toml::node* ignore = block.get("ignore")) {
      const auto ranges = read_ids(*ignore, entry.family);
      if (!ranges) return tl::make_unexpected(ranges.error());
      for (const auto& [first, last] : *ranges) {
        for (int id = first; id <= last; ++id) {
          if (!entry.ignored.insert(id).second) {
            return fail(ErrorKind::bad_data,
                        "{}: id {} is ignored already; it stands in two ranges",
                        toml_place(name_, *ignore), id);
          }
        }
      }
    }
    if (const toml::node* sizes = block.get("sizes")) {
      if (const auto status = read_sizes(*sizes, entry); !status) {
        return tl::make_unexpected(status.error());
      }
    }
    if (const toml::node* scale = block.get("print_scale")) {
      const auto factor = read_print_scale(*scale);
      if (!factor) return tl::make_unexpected(factor.error());
      entry.print_scale = *factor;
      if (entry.default_size_m) *entry.default_size_m *= *factor;
      for (auto& [id, size_m] : entry.size_m_by_id) size_m *= *factor;
    }
    if (const toml::node* inverted = block.get("inverted")) {
      const auto said = inverted->value_exact<bool>();
      if (!said) {
        return fail(ErrorKind::bad_data, "{}: inverted must be true or false",
                    toml_place(name_, *inverted));
      }
      entry.inverted = *said;
    }
    if (!entry.default_size_m && entry.size_m_by_id.empty()) {
      return fail(ErrorKind::bad_data,
                  "{}: family \"{}\" has no size; give size_m, or [[markers.sizes]] with ids",
                  toml_place(name_, block), name_of(entry.family));
    }
    return entry;
  }

  Expected<Family> read_family(const toml::table& block) const {
    const toml::node* const node = block.get("family");
    const auto text = node != nullptr ? node->value<std::string>() : std::nullopt;
    if (!text) {
      return fail(ErrorKind::bad_data, "{}: no family; write for instance family = \"tag36h11\"",
                  toml_place(name_, node != nullptr ? *node : block));
    }
    const auto family = family_from_name(*text);
    if (!family) {
      std::vector<std::string_view> names;
      for (const FamilyTraits& known : all_families()) names.push_back(known.name);
      return fail(ErrorKind::bad_data, "{}: unknown family \"{}\"; known: {}",
                  toml_place(name_, *node), *text, fmt::join(names, ", "));
    }
    return *family;
  }

  Expected<double> read_size(const toml::node& node) const {
    const auto size_m = node.is_number() ? node.value<double>() : std::nullopt;
    if (!size_m || !std::isfinite(*size_m) || *size_m <= 0 || *size_m > kMaxSize_m) {
      return fail(ErrorKind::bad_data,
                  "{}: size_m must be a number above 0 and at most {} (metres, outer edge of the "
                  "black border)",
                  toml_place(name_, node), kMaxSize_m);
    }
    return *size_m;
  }

  /// How sure the size beside it is, where that is stated.
  Expected<std::optional<double>> read_size_sigma(const toml::table& block,
                                                  std::optional<double> size_m) const {
    const toml::node* const node = block.get("size_sigma_m");
    if (node == nullptr) return std::nullopt;
    if (!size_m) {
      return fail(ErrorKind::bad_data, "{}: size_sigma_m without a size_m beside it",
                  toml_place(name_, *node));
    }
    const auto sigma_m = node->is_number() ? node->value<double>() : std::nullopt;
    if (!sigma_m || !(*sigma_m > 0 && *sigma_m < *size_m)) {
      return fail(ErrorKind::bad_data,
                  "{}: size_sigma_m must be a number above 0 and below size_m, one standard "
                  "deviation in metres",
                  toml_place(name_, *node));
    }
    return sigma_m;
  }

  /// What the ruler of a printed sheet measures, by what it should.
  Expected<double> read_print_scale(const toml::node& node) const {
    constexpr double kLeast = 0.5;
    constexpr double kMost = 2.0;
    const auto scale = node.is_number() ? node.value<double>() : std::nullopt;
    if (!scale || !(*scale >= kLeast && *scale <= kMost)) {
      return fail(ErrorKind::bad_data,
                  "{}: print_scale must be a number within {} and {}: the ruler's length as "
                  "measured, by that as printed",
                  toml_place(name_, node), kLeast, kMost);
    }
    return *scale;
  }

  Status read_sizes(const toml::node& sizes, FamilyEntry& entry) const {
    if (!sizes.is_array_of_tables()) {
      return fail(ErrorKind::bad_data, "{}: sizes must be [[markers.sizes]] blocks",
                  toml_place(name_, sizes));
    }
    for (const toml::node& node : *sizes.as_array()) {
      const toml::table& block = *node.as_table();
      if (auto status = check_toml_keys(block, {"ids", "size_m", "size_sigma_m", "group"}, name_);
          !status) {
        return status;
      }
      const toml::node* const ids = block.get("ids");
      const toml::node* const size = block.get("size_m");
      if (ids == nullptr || size == nullptr) {
        return fail(ErrorKind::bad_data, "{}: [[markers.sizes]] needs ids and size_m",
                    toml_place(name_, block));
      }
      const auto size_m = read_size(*size);
      if (!size_m) return tl::make_unexpected(size_m.error());
      const auto sigma_m = read_size_sigma(block, *size_m);
      if (!sigma_m) return tl::make_unexpected(sigma_m.error());
      const auto group = read_group(block);
      if (!group) return tl::make_unexpected(group.error());
      const auto ranges = read_ids(*ids, entry.family);
      if (!ranges) return tl::make_unexpected(ranges.error());
      for (const auto& [first, last] : *ranges) {
        for (int id = first; id <= last; ++id) {
          if (!entry.size_m_by_id.emplace(id, *size_m).second) {
            return fail(ErrorKind::bad_data,
                        "{}: id {} has a size already; it stands in two ranges",
                        toml_place(name_, *ids), id);
          }
          if (*sigma_m) entry.size_sigma_m_by_id.emplace(id, **sigma_m);
          if (!group->empty()) entry.group_by_id.emplace(id, *group);
        }
      }
    }
    return {};
  }

  /// Empty where none is stated.
  Expected<std::string> read_group(const toml::table& block) const {
    const toml::node* const node = block.get("group");
    if (node == nullptr) return std::string();
    const auto text = node->value_exact<std::string>();
    if (!text || text->empty() || text->size() > MarkerCatalog::kMostGroupBytes ||
        in_one_line(*text) != *text) {
      return fail(ErrorKind::bad_data,
                  "{}: group must be a printable text of 1 to {} bytes, such as \"shelf 12\"",
                  toml_place(name_, *node), MarkerCatalog::kMostGroupBytes);
    }
    return *text;
  }

  /// ids = "100-199, 205" or [100, 101].
  Expected<std::vector<IdRange>> read_ids(const toml::node& node, Family family) const {
    std::vector<IdRange> ranges;
    const auto add = [&](std::string_view text, const toml::node& at) -> Status {
      const auto parsed = parse_id_ranges(text, family);
      if (!parsed) {
        return fail(ErrorKind::bad_data, "{}: {}", toml_place(name_, at), parsed.error().message);
      }
      ranges.insert(ranges.end(), parsed->begin(), parsed->end());
      return {};
    };
    if (const auto text = node.value<std::string>()) {
      if (auto added = add(*text, node); !added) return tl::make_unexpected(added.error());
      return ranges;
    }
    const toml::array* const list = node.as_array();
    if (list == nullptr) {
      return fail(ErrorKind::bad_data, "{}: ids must be a text such as \"100-199, 205\" or a list",
                  toml_place(name_, node));
    }
    for (const toml::node& item : *list) {
      const auto number = item.is_integer() ? item.value<std::int64_t>() : std::nullopt;
      const std::string text =
          number ? fmt::format("{}", *number) : item.value_or(std::string("?"));
      if (const auto status = add(text, item); !status) {
        return tl::make_unexpected(status.error());
      }
    }
    return ranges;
  }

  const std::string& name_;
};

}  // namespace

std::optional<double> MarkerCatalog::size_m(const MarkerId& id) const {
  for (const FamilyEntry& entry : entries_) {
    if (entry.family != id.family) continue;
    if (id.number < 0 || id.number >= traits(id.family).id_count) return std::nullopt;
    if (entry.ignored.contains(id.number)) return std::nullopt;
    const auto listed = entry.size_m_by_id.find(id.number);
    return listed != entry.size_m_by_id.end() ? listed->second : entry.default_size_m;
  }
  return std::nullopt;
}

bool MarkerCatalog::ignores(const MarkerId& id) const {
  return std::any_of(entries_.begin(), entries_.end(), [&](const FamilyEntry& entry) {
    return entry.family == id.family && entry.ignored.contains(id.number);
  });
}

std::optional<double> MarkerCatalog::size_sigma_m(const MarkerId& id) const {
  const auto size = size_m(id);
  if (!size) return std::nullopt;
  const auto entry = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const FamilyEntry& one) { return one.family == id.family; });
  if (const auto listed = entry->size_sigma_m_by_id.find(id.number);
      listed != entry->size_sigma_m_by_id.end()) {
    return listed->second;
  }
  const bool is_default = !entry->size_m_by_id.contains(id.number);
  if (is_default && entry->default_size_sigma_m) return entry->default_size_sigma_m;
  return default_size_sigma_m(*size);
}

std::string MarkerCatalog::group(const MarkerId& id) const {
  for (const FamilyEntry& entry : entries_) {
    if (entry.family != id.family) continue;
    const auto listed = entry.group_by_id.find(id.number);
    if (listed != entry.group_by_id.end()) return listed->second;
  }
  return {};
}

MarkerCatalog MarkerCatalog::with_exact_sizes() const {
  constexpr double kExact_m = 1e-9;
  MarkerCatalog exact = *this;
  for (FamilyEntry& entry : exact.entries_) {
    if (entry.default_size_m) entry.default_size_sigma_m = kExact_m;
    for (const auto& [id, size_m] : entry.size_m_by_id) entry.size_sigma_m_by_id[id] = kExact_m;
  }
  return exact;
}

bool MarkerCatalog::shows_light_squares(Family family) const {
  const auto entry = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const FamilyEntry& one) { return one.family == family; });
  return marker_layout(family).is_light() != (entry != entries_.end() && entry->inverted);
}

MeetingFamilies MarkerCatalog::families() const {
  MeetingFamilies families;
  for (const FamilyEntry& entry : entries_) families.add(entry.family);
  return families;
}

std::string MarkerCatalog::fingerprint() const {
  MarkerCatalog canonical = *this;
  std::sort(canonical.entries_.begin(), canonical.entries_.end(),
            [](const FamilyEntry& a, const FamilyEntry& b) { return a.family < b.family; });
  for (FamilyEntry& entry : canonical.entries_) {
    entry.default_size_sigma_m.reset();
    entry.size_sigma_m_by_id.clear();
    entry.group_by_id.clear();
  }
  const std::string text = format_marker_catalog(canonical);
  return fmt::format("{:016x}", XXH3_64bits(text.data(), text.size()));
}

double default_size_sigma_m(double size_m) {
  constexpr double kShare = 0.001;
  constexpr double kLeast_m = 0.0002;
  return std::max(kShare * size_m, kLeast_m);
}

Expected<MarkerCatalog> read_marker_catalog(const std::filesystem::path& path) {
  const auto root = read_toml(path);
  if (!root) return tl::make_unexpected(root.error());
  return CatalogReader(path.string()).read(*root);
}

Expected<MarkerCatalog> parse_marker_catalog(std::string_view text, const std::string& name) {
  const auto root = parse_toml(text, name);
  if (!root) return tl::make_unexpected(root.error());
  return CatalogReader(name).read(*root);
}

}  // namespace waymark
