#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace waymark {

/// Marker dictionaries, with the names of markers.toml. Values are stored in map files: never
/// renumber, only append.
enum class Family : std::uint8_t {
  aruco_4x4_50 = 0,
  aruco_4x4_100 = 1,
  aruco_4x4_250 = 2,
  aruco_4x4_1000 = 3,
  aruco_5x5_50 = 4,
  aruco_5x5_100 = 5,
  aruco_5x5_250 = 6,
  aruco_5x5_1000 = 7,
  aruco_6x6_50 = 8,
  aruco_6x6_100 = 9,
  aruco_6x6_250 = 10,
  aruco_6x6_1000 = 11,
  aruco_7x7_50 = 12,
  aruco_7x7_100 = 13,
  aruco_7x7_250 = 14,
  aruco_7x7_1000 = 15,
  aruco_original = 16,
  tag16h5 = 17,
  tag25h9 = 18,
  tag36h10 = 19,
  tag36h11 = 20,
  tagstandard52h13 = 21,  ///< 48,714 ids, for buildings of 20,000 markers
  aruco_mip_36h12 = 22,
  tagstandard41h12 = 23,
  tagcircle21h7 = 24,
  tagcircle49h12 = 25,
  tagcustom48h12 = 26,
};

/// What a family is.
struct FamilyTraits {
  Family family;
  std::string_view name;
  int code_bits;  ///< cells that tell markers apart
  int id_count;
  int distance;  ///< fewest code cells in which two markers differ, any way up
};

/// The families that this program prints and finds in images.
[[nodiscard]] std::span<const FamilyTraits> all_families();

[[nodiscard]] const FamilyTraits& traits(Family family);

/// nullopt for an unknown name; in those of AprilTag's later families, which have capitals, case is
/// no matter.
[[nodiscard]] std::optional<Family> family_from_name(std::string_view name);
[[nodiscard]] inline std::string_view name_of(Family family) { return traits(family).name; }

/// nullopt for a number that is no family (a damaged or newer file).
[[nodiscard]] std::optional<Family> family_from_number(int number);

/// The families that meet somewhere: in a capture, a map, a report. Where several do, ids are
/// written "family:number", and a bare number means none.
class MeetingFamilies {
 public:
  void add(Family family) {
    several_ = several_ || (first_ && *first_ != family);
    if (!first_) first_ = family;
  }
  [[nodiscard]] bool several() const { return several_; }
  /// The only one; nullopt where there is none, or where several meet.
  [[nodiscard]] std::optional<Family> only() const { return several_ ? std::nullopt : first_; }

 private:
  std::optional<Family> first_;
  bool several_ = false;
};

}  // namespace waymark
