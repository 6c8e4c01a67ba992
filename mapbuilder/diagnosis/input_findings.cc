#include "mapbuilder/diagnosis/input_findings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/marker/nested_families.h"

namespace waymark {
namespace {

/// What one camera gave.
struct Yield {
  std::size_t images = 0;
  std::size_t markers = 0;
};

std::vector<Yield> yields_of(const DetectedCapture& capture) {
  std::vector<Yield> yields(capture.rig.cameras.size());
  for (const ImageDetections& image : capture.images) {
    Yield& yield = yields[static_cast<std::size_t>(image.camera)];
    ++yield.images;
    yield.markers += image.detections.size();
  }
  return yields;
}

/// "0-2, 7": numbers in ranges, at most ten of these.
std::string ranges_of(const std::set<int>& numbers) {
  std::vector<std::string> ranges;
  for (auto it = numbers.begin(); it != numbers.end();) {
    const int first = *it;
    int last = first;
    for (++it; it != numbers.end() && *it == last + 1; ++it) last = *it;
    ranges.push_back(first == last ? fmt::format("{}", first) : fmt::format("{}-{}", first, last));
  }
  constexpr std::size_t kMost = 10;
  if (ranges.size() > kMost) {
    ranges.resize(kMost);
    ranges.emplace_back("…");
  }
  return fmt::format("{}", fmt::join(ranges, ", "));
}

std::string ids(const std::set<int>& numbers) {
  return (numbers.size() == 1 ? "id " : "ids ") + ranges_of(numbers);
}

/// ln of the chance that of `tries` at least `hits` succeed.
double ln_tail(int tries, int hits, double chance) {
  if (hits <= 0) return 0;
  double sum = 0;
  for (int j = hits; j <= tries; ++j) {
    sum += std::exp(std::lgamma(tries + 1) - std::lgamma(j + 1) - std::lgamma(tries - j + 1) +
                    j * std::log(chance) + (tries - j) * std::log1p(-chance));
  }
  return sum > 0 ? std::log(sum) : -1e3;
}

/// Whether so many squares do not read so by chance. One square on a wall is seen in many images:
/// its numbers count, not its sights.
bool is_no_chance(const SquareReader& reader, const OtherForm& form, const FormCount& count) {
  constexpr double kUnlikely = -10;  // one in 20,000
  const auto unlikely = [&](int squares, const std::set<int>& numbers, bool exact) {
    if (squares == 0) return false;
    const int hits = static_cast<int>(numbers.size());
    const double sights = static_cast<double>(squares) / hits;
    const int tries = std::max(hits, static_cast<int>(std::ceil(count.could / sights)));
    const double chance = std::min(0.5, reader.chance_of(form.form, exact));
    return ln_tail(tries, hits, chance) < kUnlikely;
  };
  return unlikely(count.squares, count.numbers, false) ||
         unlikely(count.exact, count.exact_numbers, true);
}

/// What most of a camera's unexplained squares read as, if that is no chance.
std::optional<OtherForm> surest_form(const SquareReader& reader, const CameraLook& look) {
  std::optional<OtherForm> best;
  for (const auto& [form, count] : look.others) {
    if (count.squares == 0 || !is_no_chance(reader, form, count)) continue;
    // Beside markers that are found some are too small, or half outside the image.
    if (form.no_outline && count.squares <= look.stated) continue;
    // Of forms that explain as much the plainest: they come in this order, and what has an outline
    // before what has none.
    const auto weight = [&](const OtherForm& one) {
      return (one.no_outline ? 1 : 2) * look.others.at(one).squares;
    };
    if (!best || weight(form) > weight(*best)) best = form;
  }
  return best;
}

Cause cause_of(const OtherForm& form) {
  if (form.form.mirrored) return Cause::mirrored;
  if (form.inverted) return Cause::inverted_print;
  if (form.no_outline) return Cause::margin;
  return form.form.other_border ? Cause::border : Cause::family;
}

/// Cameras of one capture that show the same other form.
struct FormFound {
  OtherForm form;
  FormCount count;
  std::vector<std::string> cameras;
  int stated = 0;             ///< squares of theirs that read as they ought to
  bool every_camera = false;  ///< that was looked at
};

std::vector<FormFound> forms_found(const std::vector<CameraLook>& looks) {
  const SquareReader reader;
  std::vector<FormFound> found;
  std::size_t looked_at = 0;
  for (const CameraLook& look : looks) {
    looked_at += look.images > 0 ? 1 : 0;
    const auto form = surest_form(reader, look);
    if (!form) continue;
    auto known = std::find_if(found.begin(), found.end(),
                              [&](const FormFound& one) { return one.form == *form; });
    if (known == found.end()) known = found.insert(found.end(), FormFound{*form, {}, {}, 0, false});
    const FormCount& count = look.others.at(*form);
    known->cameras.push_back(look.camera);
    known->stated += look.stated;
    known->count.squares += count.squares;
    known->count.border_cells += count.border_cells;
    known->count.numbers.insert(count.numbers.begin(), count.numbers.end());
  }
  for (FormFound& one : found) one.every_camera = one.cameras.size() == looked_at;
  return found;
}

/// How a form's squares differ from what is stated, and what to do.
void put_into_words(const FormFound& found, std::string_view family, Finding& finding) {
  const double border = found.count.border_cells / found.count.squares;
  std::string otherwise;
  if (found.form.form.mirrored) {
    otherwise += found.every_camera
                     ? ", mirrored: images or prints are mirrored left-right"
                     : fmt::format(", mirrored: the images of {} are mirrored left-right",
                                   fmt::join(found.cameras, ", "));
    finding.remedy = "Switch the mirroring off in the driver, or hang the prints right side out.";
  }
  if (found.form.inverted) {
    otherwise += ", white on black: the prints are inverted";
    finding.remedy = "Print the markers black on white.";
  }
  if (found.form.no_outline) {
    otherwise += ", but stand dark on dark: no outline is found around them";
    finding.remedy = "Put white paper of a cell's width around every marker.";
  } else if (found.form.form.other_border) {
    otherwise +=
        fmt::format(", with a black border of {:.1f} cells; markers need one cell", border);
    finding.remedy += std::string(finding.remedy.empty() ? "" : " ") +
                      (border < 1 ? "Was the border cut? Print it whole; size_m is its outer edge."
                                  : "Print with a border of one cell.");
  }
  finding.text = fmt::format(
      "{} squares read as {} ({}){}{}.", found.count.squares, family, ids(found.count.numbers),
      otherwise,
      found.stated > 0 ? fmt::format("; {} read as markers.toml states", found.stated) : "");
  if (finding.cause == Cause::family) finding.remedy = "State that family in markers.toml.";
}

Finding form_finding(const FormFound& found, const DetectedCapture& capture) {
  Finding finding;
  finding.cause = cause_of(found.form);
  // What is read rightly beside it may be chance readings of the same squares.
  finding.severity = 2 * found.stated >= found.count.squares ? Severity::warning : Severity::error;
  const Family representative = found.form.form.family;
  const Family family = smallest_holding(representative, *found.count.numbers.rbegin());
  for (const auto& entry : capture.catalog.entries()) {
    // A stated family that the found one contains is right as far as it goes.
    if (finding.cause == Cause::family && found.stated > 0 &&
        share_codes(entry.family, representative)) {
      finding.severity = Severity::warning;
    }
  }
  finding.subject =
      found.every_camera ? capture.name : fmt::format("{}", fmt::join(found.cameras, ", "));
  finding.cameras = found.cameras;
  finding.captures = {capture.name};
  finding.figures = {{"squares that read so", static_cast<double>(found.count.squares), "", {}}};
  put_into_words(found, name_of(family), finding);
  return finding;
}

/// Families whose every mirrored code is a code again: then only what stands upside down tells.
bool is_closed_under_mirroring(Family family) { return family == Family::aruco_original; }

std::optional<Finding> upside_down_finding(const DetectedCapture& capture,
                                           const std::vector<CameraLook>& looks) {
  if (capture.catalog.entries().size() != 1 ||
      !is_closed_under_mirroring(capture.catalog.entries().front().family)) {
    return std::nullopt;
  }
  int stated = 0;
  int upside_down = 0;
  std::set<int> numbers;
  for (const CameraLook& look : looks) {
    stated += look.stated;
    upside_down += look.upside_down;
    numbers.insert(look.stated_numbers.begin(), look.stated_numbers.end());
  }
  if (numbers.size() < 3 || 10 * upside_down < 9 * stated) return std::nullopt;
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::mirrored;
  finding.subject = capture.name;
  finding.text = fmt::format(
      "{} of {} markers stand upside down in the images, and every mirrored code of {} is one of "
      "another id: images or prints are mirrored left-right, or all cameras hang upside down.",
      upside_down, stated, name_of(capture.catalog.entries().front().family));
  finding.remedy =
      "Compare the ids on the walls with those found; if they are right, build with "
      "--accept-errors.";
  finding.captures = {capture.name};
  finding.figures = {{"markers upside down", static_cast<double>(upside_down), "", {}}};
  return finding;
}

std::optional<Finding> cut_finding(const DetectedCapture& capture,
                                   const std::vector<CameraLook>& looks) {
  int stated = 0;
  int cut = 0;
  double cells = 0;
  for (const CameraLook& look : looks) {
    stated += look.stated;
    cut += look.stated_cut;
    cells += look.cut_cells;
  }
  if (cut < 3 || 10 * cut < 7 * stated) return std::nullopt;
  Finding finding;
  finding.cause = Cause::border;
  finding.subject = capture.name;
  finding.text = fmt::format(
      "the black border of {} of {} markers looked at is {:.1f} cells wide instead of one: it was "
      "cut, or size_m is not its outer edge.",
      cut, stated, cells / cut);
  finding.remedy = "Measure the outer edge of what is left of the black, and state that as size_m.";
  finding.captures = {capture.name};
  finding.figures = {{"border", cells / cut, "cells", {}}};
  return finding;
}

/// Whether a single square may read as some code of the family by chance.
bool may_be_chance(Family family) {
  constexpr double kRare = 0.01;
  const FamilyTraits& family_traits = traits(family);
  return 4.0 * family_traits.id_count > kRare * std::exp2(family_traits.code_bits);
}

std::optional<Finding> unlisted_finding(const DetectedCapture& capture,
                                        const std::vector<CameraLook>& looks, bool nothing_found) {
  std::map<Family, std::set<int>> numbers;
  std::vector<MarkerId> markers;
  int sights = 0;
  std::map<MarkerId, int> seen = capture.unlisted;
  for (const CameraLook& look : looks) {
    for (const auto& [id, count] : look.unlisted) {
      if (count > 1 || !may_be_chance(id.family)) seen[id] += count;
    }
  }
  for (const auto& [id, count] : seen) {
    numbers[id.family].insert(id.number);
    markers.push_back(id);
    sights += count;
  }
  if (sights == 0) return std::nullopt;
  std::string text;
  for (const auto& [family, of_family] : numbers) {
    text += fmt::format(
        "{}{}{}", text.empty() ? "" : "; ", ids(of_family),
        family == capture.catalog.only_family() ? "" : fmt::format(" of {}", name_of(family)));
  }
  Finding finding;
  finding.severity = nothing_found ? Severity::error : Severity::note;
  finding.cause = Cause::unlisted_ids;
  finding.subject = capture.name;
  finding.text =
      fmt::format("{} {} seen {} times and {} not listed in markers.toml{}.", text,
                  markers.size() == 1 ? "was" : "were", sights, markers.size() == 1 ? "is" : "are",
                  nothing_found ? "; nothing else was found" : "");
  finding.remedy = "Add their sizes, or put them into `ignore`.";
  finding.markers = markers;
  finding.captures = {capture.name};
  finding.figures = {{"sights", static_cast<double>(sights), "", {}}};
  return finding;
}

/// Mean grey value of what is nearly black.
constexpr double kDark = 16;

std::optional<Finding> darkness_finding(const DetectedCapture& capture,
                                        const std::vector<CameraLook>& looks) {
  double brightest = 0;
  std::size_t images = 0;
  for (const CameraLook& look : looks) {
    if (look.images == 0) continue;
    brightest = std::max(brightest, look.mean_grey);
    images += look.images;
  }
  if (images == 0 || brightest > kDark) return std::nullopt;
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::dark;
  finding.subject = capture.name;
  finding.text = fmt::format(
      "images are nearly black (mean {:.0f} of 255), and nothing is found in them.", brightest);
  finding.remedy = "Expose longer, add light, take off the cap.";
  finding.captures = {capture.name};
  finding.figures = {{"mean grey value", brightest, "", {}}};
  return finding;
}

/// Nothing was found and no closer look tells why.
Finding nothing_finding(const DetectedCapture& capture, const std::vector<CameraLook>& looks) {
  std::size_t images = 0;
  int squares = 0;
  for (const CameraLook& look : looks) {
    images += look.images;
    squares += look.squares;
  }
  Finding finding;
  finding.severity = Severity::error;
  finding.cause = Cause::blind_camera;
  finding.subject = capture.name;
  finding.text = fmt::format(
      "no marker in {} images; of the {} dark squares in {} of them looked at again none reads as "
      "a "
      "code of any family.",
      capture.images.size(), squares, images);
  finding.remedy =
      "Look at the images: are markers there, sharp, 12 pixels and more, with a white margin?";
  finding.captures = {capture.name};
  return finding;
}

Finding blind_finding(const CameraLook& look, const Yield& yield, const DetectedCapture& capture) {
  Finding finding;
  finding.cause = Cause::blind_camera;
  finding.subject = look.camera;
  const std::string grey =
      look.images > 0 ? fmt::format(" (mean grey level {:.0f} of 255)", look.mean_grey) : "";
  finding.text =
      yield.images == 0
          ? fmt::format("not one image of it in {}: its place in rig.yaml could not be checked.",
                        capture.name)
          : fmt::format(
                "found no marker in {} images{} of {}: its place in rig.yaml could not be "
                "checked.",
                yield.images, grey, capture.name);
  finding.remedy = look.images > 0 && look.mean_grey <= kDark
                       ? "Take off the cap, expose longer."
                       : "Look at its images; take it out of rig.yaml if it is not to be used.";
  finding.cameras = {look.camera};
  finding.captures = {capture.name};
  return finding;
}

}  // namespace

std::vector<Finding> input_findings(const DetectedCapture& capture,
                                    const std::vector<CameraLook>& looks) {
  std::vector<Finding> findings;
  std::set<std::string> explained;
  const auto add = [&](std::optional<Finding> finding) {
    if (!finding) return;
    explained.insert(finding->cameras.begin(), finding->cameras.end());
    findings.push_back(*std::move(finding));
  };
  const std::vector<Yield> yields = yields_of(capture);
  const bool nothing_found = std::all_of(yields.begin(), yields.end(),
                                         [](const Yield& yield) { return yield.markers == 0; });
  const bool looked = std::any_of(looks.begin(), looks.end(),
                                  [](const CameraLook& look) { return look.images > 0; });
  if (looked) {
    for (const FormFound& found : forms_found(looks)) add(form_finding(found, capture));
  }
  add(upside_down_finding(capture, looks));
  add(cut_finding(capture, looks));
  add(unlisted_finding(capture, looks, nothing_found));
  if (nothing_found) {
    if (findings.empty()) add(darkness_finding(capture, looks));
    if (findings.empty() && looked) add(nothing_finding(capture, looks));
    return findings;
  }
  for (std::size_t camera = 0; camera < looks.size(); ++camera) {
    if (yields[camera].markers > 0 || explained.contains(looks[camera].camera)) continue;
    add(blind_finding(looks[camera], yields[camera], capture));
  }
  return findings;
}

}  // namespace waymark
