#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/map/quarantine.h"
#include "locd/record/quarantine_file.h"

namespace waymark {

/// Which markers are not used, and since when: those that localization has put into quarantine,
/// which belong to a map, and those that somebody has told locd to ignore, whatever the map.
/// Each change is written to quarantine.json. One thread calls it.
class UnusedMarkers {
 public:
  static constexpr std::size_t kMostIgnored = 256;

  /// What the file says, for the map of that hash; without a map ("") the file's own stays as it
  /// is.
  UnusedMarkers(QuarantineFile& file, std::string map_hash);

  /// Another map is in use, in which `found` is known to be in quarantine; what is ignored stays.
  void use_map(std::string map_hash, std::vector<QuarantinedMarker> found);
  /// All that localization now has in quarantine with the map of that hash; of another map nothing
  /// is taken. `utime` (µs): when those began that were not in it before.
  void set_found(const std::string& map_hash, std::vector<QuarantinedMarker> found,
                 std::int64_t utime);

  /// Leave the marker out from now on, if it is not already. usage: kMostIgnored are.
  [[nodiscard]] Status ignore(const MarkerId& marker, std::int64_t utime);
  /// Use it again. bad_data: it was not ignored.
  [[nodiscard]] Status allow(const MarkerId& marker);

  /// Whether localization has it in quarantine, in the map that is in use.
  [[nodiscard]] bool is_quarantined(const MarkerId& marker) const;
  /// How many it has there.
  [[nodiscard]] std::size_t quarantined() const;
  /// By rising id.
  [[nodiscard]] std::vector<MarkerId> ignored() const;

 private:
  void write() const;

  QuarantineFile& file_;
  bool has_map_ = false;
  std::string found_with_;                  ///< hash of the map that `found_` belongs to
  std::vector<QuarantinedMarker> found_;    ///< moved and unknown ones
  std::vector<QuarantinedMarker> ignored_;  ///< by rising id
};

}  // namespace waymark
