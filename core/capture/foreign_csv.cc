#include "core/capture/foreign_csv.h"

#include <algorithm>
#include <array>
#include <vector>

#include "core/base/text_field.h"
#include "core/capture/stamp_doubt.h"

namespace waymark {
namespace {

/// Of all rows: what nearly all have in common is no damage but another convention.
bool nearly_all(std::size_t some, std::size_t all) { return some > 0 && 5 * some > 4 * all; }

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Whether the outline turns the same way at every corner.
bool is_convex(const ImageCorners& corners) {
  int turns = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d in = corners[(i + 1) % 4] - corners[i];
    const Eigen::Vector2d out = corners[(i + 2) % 4] - corners[(i + 1) % 4];
    turns += cross(in, out) > 0 ? 1 : -1;
  }
  return turns == 4 || turns == -4;
}

bool same_row(const Detection& a, const Detection& b) {
  return a.marker == b.marker && a.corners == b.corners && a.hamming == b.hamming;
}

/// Of detections in the table's order.
std::size_t count_repeated_rows(const DetectionsTable& table) {
  std::size_t repeated = 0;
  for (const ImageDetections& image : table.images) {
    for (std::size_t i = 1; i < image.detections.size(); ++i) {
      repeated += same_row(image.detections[i - 1], image.detections[i]) ? 1 : 0;
    }
  }
  return repeated;
}

std::size_t count_rows(const DetectionsTable& table) {
  std::size_t rows = 0;
  for (const ImageDetections& image : table.images) rows += image.detections.size();
  return rows;
}

/// One stamp for all rows, though markers are seen several times in one image.
std::optional<std::string> one_stamp_for_all(const DetectionsTable& table) {
  std::size_t repeated = 0;
  for (const ImageDetections& image : table.images) {
    if (image.stamp != table.images.front().stamp) return std::nullopt;
    for (std::size_t i = 1; i < image.detections.size(); ++i) {
      repeated += image.detections[i - 1].marker == image.detections[i].marker ? 1 : 0;
    }
  }
  if (2 * repeated <= count_rows(table)) return std::nullopt;
  return fmt::format("all stamps are {}; state when each image was taken, in ns",
                     table.images.front().stamp.count());
}

}  // namespace

std::string_view foreign_encoding(std::string_view first_line) {
  if (first_line.starts_with("\xFF\xFE") || first_line.starts_with("\xFE\xFF") ||
      first_line.substr(0, 16).find('\0') != std::string_view::npos) {
    return "this is UTF-16; save it as UTF-8, or: iconv -f UTF-16 -t UTF-8";
  }
  return {};
}

std::string foreign_header(std::string_view header) {
  constexpr std::string_view kExample = "t_ns,camera,marker_id,x0,y0,…";
  struct Separator {
    char character;
    std::string_view name;
  };
  constexpr std::array<Separator, 3> kSeparators{{{';', "\";\""}, {'\t', "tabs"}, {'|', "\"|\""}}};
  const auto count = [&](char c) { return std::count(header.begin(), header.end(), c); };
  for (const auto& [character, name] : kSeparators) {
    if (count(character) <= count(',')) continue;
    return fmt::format(
        "columns are separated by {}; save it with commas, and with points in numbers: {}", name,
        kExample);
  }
  if (header.starts_with('"') || header.starts_with('\'')) {
    return fmt::format("names stand in quotes; save it without: {}", kExample);
  }
  return {};
}

std::string_view why_no_stamp(std::string_view field) {
  const auto number = parse_whole<double>(field);
  const bool written_out = field.find_first_of("eE") == std::string_view::npos;
  if (number && !written_out && *number > 1e9) {
    return "was rounded by a spreadsheet; write all digits of the whole number of ns";
  }
  if (number && written_out && field.find('.') != std::string_view::npos && *number > 0) {
    return "is no whole number of ns; in s? Multiply by 1000000000, before it is rounded";
  }
  return "is no whole number of ns";
}

bool CornerOrders::add(const ImageCorners& corners) {
  const double sense = cross(corners[2] - corners[0], corners[3] - corners[1]);
  ++rows_;
  clockwise_ += sense > 0 ? 1 : 0;
  if (!is_convex(corners)) {
    ++crossed_;
  } else if (sense < 0) {
    ++counterclockwise_;
  }
  return sense > 0;
}

std::string CornerOrders::doubt() const {
  if (nearly_all(counterclockwise_, rows_)) {
    return fmt::format(
        "in {} of {} rows the corners run counter-clockwise; they are top-left, top-right, "
        "bottom-right, bottom-left, y down: if they run bottom-left, bottom-right, top-right, "
        "top-left, as the apriltag library's do, write them in reverse; if y runs up, write "
        "height - 1 - y",
        counterclockwise_, rows_);
  }
  if (nearly_all(crossed_, rows_)) {
    return fmt::format(
        "in {} of {} rows the corners' outline crosses itself; they are top-left, top-right, "
        "bottom-right, bottom-left",
        crossed_, rows_);
  }
  return {};
}

std::optional<TableDoubt> doubt_of_table(const DetectionsTable& table, const CornerOrders& orders,
                                         bool monotonic) {
  const std::size_t repeated = count_repeated_rows(table);
  if (repeated > 0 && 100 * repeated >= 49 * count_rows(table)) {
    return TableDoubt{Cause::csv, "every row stands twice; write each once"};
  }
  if (auto text = orders.doubt(); !text.empty()) return TableDoubt{Cause::csv, std::move(text)};
  if (auto text = one_stamp_for_all(table)) return TableDoubt{Cause::stamps, std::move(*text)};
  std::vector<StampedImage> images;
  images.reserve(table.images.size());
  for (const ImageDetections& image : table.images) images.push_back({image.camera, image.stamp});
  if (auto text = doubt_of_span(images)) return TableDoubt{Cause::stamps, std::move(*text)};
  if (auto text = doubt_of_stamps(images, monotonic)) {
    return TableDoubt{Cause::stamps, std::move(*text)};
  }
  return std::nullopt;
}

}  // namespace waymark
