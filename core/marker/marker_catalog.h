#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/marker/marker_id.h"

namespace waymark {

/// The markers that exist in a building: families in use, sizes, ids to ignore (markers.toml).
class MarkerCatalog {
 public:
  /// One [markers] block.
  struct FamilyEntry {
    Family family = Family::aruco_4x4_1000;
    std::optional<double> default_size_m;  ///< without it only the listed ids exist
    std::map<int, double> size_m_by_id;
    std::set<int> ignored;
    double print_scale = 1;                        ///< that the sizes above have in them
    std::optional<double> default_size_sigma_m{};  ///< as stated beside the default size
    std::map<int, double> size_sigma_m_by_id{};    ///< of listed ids, where stated
    bool inverted = false;                         ///< printed white for black
    std::map<int, std::string> group_by_id{};      ///< of listed ids, where stated
  };

  MarkerCatalog() = default;
  explicit MarkerCatalog(std::vector<FamilyEntry> entries) : entries_(std::move(entries)) {}

  [[nodiscard]] const std::vector<FamilyEntry>& entries() const { return entries_; }

  /// Side of the marker's square (m): the outer edge of the black border, or of the white one
  /// within the black ring of families that have such (MarkerLayout). nullopt for a marker that is
  /// ignored or does not exist here.
  [[nodiscard]] std::optional<double> size_m(const MarkerId& id) const;

  /// Whether it is listed to be ignored.
  [[nodiscard]] bool ignores(const MarkerId& id) const;

  /// One standard deviation of that size (m), which is wrong alike for all markers that share it;
  /// where it is not stated, default_size_sigma_m. nullopt where size_m is.
  [[nodiscard]] std::optional<double> size_sigma_m(const MarkerId& id) const;

  /// What the marker moves together with: a shelf's, a board's or a door's name, of whatever
  /// families. Empty where none is stated.
  [[nodiscard]] std::string group(const MarkerId& id) const;
  static constexpr std::size_t kMostGroupBytes = 80;

  /// Whether the family's squares are seen light in dark: by its layout, or printed inverted.
  [[nodiscard]] bool shows_light_squares(Family family) const;

  /// Whether several families meet, so that ids are written "family:number".
  [[nodiscard]] bool several_families() const { return families().several(); }

  /// The family that a bare number means; nullopt when several meet.
  [[nodiscard]] std::optional<Family> only_family() const { return families().only(); }
  /// Those that have an entry.
  [[nodiscard]] MeetingFamilies families() const;

  /// "12" or "tag36h11:12", as several_families() asks.
  [[nodiscard]] std::string format(const MarkerId& id) const {
    return format_marker_id(id, several_families());
  }

  /// The same, its sizes stated as exact (to 1 nm): what a simulator knows.
  [[nodiscard]] MarkerCatalog with_exact_sizes() const;

  /// Stable 16-digit hexadecimal fingerprint of the content, sigmas and groups apart; written into
  /// detections.csv so that a stale one is found.
  [[nodiscard]] std::string fingerprint() const;

 private:
  std::vector<FamilyEntry> entries_;
};

/// How sure a print's size is that nobody has measured: 0.1 % of it, 0.2 mm at least.
[[nodiscard]] double default_size_sigma_m(double size_m);

/// Reads markers.toml ([markers] or several [[markers]]); a block's print_scale multiplies its
/// sizes. bad_data with line numbers for: unknown keys or families, sizes that are not positive and
/// finite (or > 100 m), a size_sigma_m that is not above 0 and below the size beside it, a
/// print_scale outside 0.5–2, ids outside the family, an id in two ranges, a family in two blocks,
/// two families of which one begins with the other, malformed ranges, a group that is no printable
/// text of 1 to 80 bytes. no_input when absent.
[[nodiscard]] Expected<MarkerCatalog> read_marker_catalog(const std::filesystem::path& path);
[[nodiscard]] Expected<MarkerCatalog> parse_marker_catalog(std::string_view text,
                                                           const std::string& name);

/// Text of a markers.toml that reads back to the same sizes, sigmas and groups, print_scale within
/// them
/// (used by the simulator, importers).
[[nodiscard]] std::string format_marker_catalog(const MarkerCatalog& catalog);

}  // namespace waymark
