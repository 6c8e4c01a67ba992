#include "core/capture/stamp_doubt.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/base/median.h"
#include "core/capture/sync_tolerance.h"

namespace waymark {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

/// Fewer distances between images tell nothing.
constexpr std::size_t kFewestSpacings = 2;
constexpr Stamp kShortestSpacing = microseconds(100);
/// Cameras of 100 images a second and more state their clock where it might be mistaken.
constexpr Stamp kShortestSpacingOfSlowClocks = milliseconds(10);

/// Times between 1998 and 2100, since 1970, in a unit.
struct Unit {
  std::string_view name;
  Stamp::rep per_second;
  std::string_view factor;  ///< to ns
};
constexpr Unit kUnits[] = {
    {"s", 1, "1000000000"}, {"ms", 1000, "1000000"}, {"µs", 1'000'000, "1000"}};

bool is_recent(Stamp stamp, Stamp::rep per_second) {
  return stamp.count() >= 883'612'800 * per_second && stamp.count() < 4'102'444'800 * per_second;
}

const Unit* unit_of(Stamp stamp) {
  const auto* const unit = std::find_if(std::begin(kUnits), std::end(kUnits), [&](const Unit& u) {
    return is_recent(stamp, u.per_second);
  });
  return unit == std::end(kUnits) ? nullptr : unit;
}

std::string looks_like(const Unit& unit, Stamp example, Stamp spacing) {
  return fmt::format("the stamps look like {} ({}, {} apart); they are ns: multiply by {}",
                     unit.name, example.count(), spacing.count(), unit.factor);
}

}  // namespace

std::optional<std::string> doubt_of_span(std::span<const StampedImage> images) {
  if (images.empty()) return std::nullopt;
  const auto [first, last] = std::minmax_element(
      images.begin(), images.end(),
      [](const StampedImage& a, const StampedImage& b) { return a.stamp < b.stamp; });
  if (time_between(first->stamp, last->stamp) <= kLargestStamp) return std::nullopt;
  return fmt::format("stamps lie more than 146 years apart ({} and {})", first->stamp.count(),
                     last->stamp.count());
}

std::optional<std::string> doubt_of_stamps(std::span<const StampedImage> images, bool monotonic) {
  std::vector<Stamp> stamps;
  for (const StampedImage& image : images) {
    if (image.stamp != Stamp::zero()) stamps.push_back(image.stamp);
  }
  if (stamps.empty()) return std::nullopt;
  const Stamp typical = upper_median(stamps);
  if (stamps.size() < images.size() && is_recent(typical, Stamp::period::den)) {
    return fmt::format(
        "{} of {} stamps are 0, the others like {}; state when those images were taken",
        images.size() - stamps.size(), images.size(), typical.count());
  }
  std::vector<Stamp> spacings = spacings_of(images);
  if (spacings.size() < kFewestSpacings) return std::nullopt;
  const Stamp spacing = upper_median(spacings);
  const Unit* const unit = unit_of(typical);
  if (spacing < kShortestSpacing) {
    if (unit != nullptr) return looks_like(*unit, typical, spacing);
    if (*std::max_element(stamps.begin(), stamps.end()) < kShortestSpacing * 1000) {
      return fmt::format(
          "the stamps look like frame numbers ({}, {} apart); they are mid-exposure times in ns, "
          "all cameras by one clock",
          typical.count(), spacing.count());
    }
    return fmt::format("the stamps lie {} apart; no camera is that fast, and they are ns",
                       spacing.count());
  }
  if (unit != nullptr && unit->per_second == 1'000'000 && !monotonic &&
      spacing < kShortestSpacingOfSlowClocks) {
    return looks_like(*unit, typical, spacing) +
           " (where they do count ns since a machine's start: clock = \"monotonic\" in "
           "capture.toml)";
  }
  return std::nullopt;
}

}  // namespace waymark
