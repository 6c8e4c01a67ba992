#include "core/capture/detections_csv.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <tuple>

#include "core/base/line_reader.h"
#include "core/base/text_field.h"
#include "core/capture/detections_csv_columns.h"
#include "core/capture/edge_moves.h"
#include "core/capture/foreign_csv.h"

namespace waymark {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
/// 20 million detections of a large building with covariances.
constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 32;
/// Of a row with covariances: 500 bytes in 24 columns.
constexpr std::size_t kLongestLine = std::size_t{1} << 16;
constexpr std::size_t kMostColumns = 64;
constexpr std::size_t kQuotedHeader = 100;  ///< bytes of a header in a message

/// No image is this wide; a corner beyond it is damage, and its square would spoil later sums.
constexpr double kMaxCorner_px = 1e6;

/// False when there are more fields than any table has columns.
bool split_at_commas(std::string_view line, std::vector<std::string_view>& fields) {
  fields.clear();
  for (std::size_t begin = 0; begin <= line.size();) {
    if (fields.size() == kMostColumns) return false;
    const auto end = std::min(line.find(',', begin), line.size());
    fields.push_back(trimmed(line.substr(begin, end - begin)));
    begin = end + 1;
  }
  return true;
}

/// Where each column stands; `kAbsent` for optional ones that the header lacks.
struct Columns {
  static constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);

  std::size_t count = 0;
  std::size_t t_ns = kAbsent;
  std::size_t camera = kAbsent;
  std::size_t marker_id = kAbsent;
  std::size_t hamming = kAbsent;
  std::size_t family = kAbsent;
  std::array<std::size_t, 8> corners{};
  std::array<std::size_t, 12> covariances{};

  [[nodiscard]] bool has_covariances() const { return covariances[0] != kAbsent; }
};

/// One row: an image, and a marker in it unless the row only says that the image was seen.
struct Row {
  Stamp stamp{0};
  int camera = 0;
  std::optional<Detection> detection;
  std::optional<MarkerId> unknown_marker;
};

class Reader {
 public:
  Reader(const std::string& name, const Rig& rig, const MarkerCatalog& catalog)
      : name_(name), rig_(rig), catalog_(catalog), only_family_(catalog.only_family()) {}

  Expected<DetectionsTable> read(LineReader& lines, bool monotonic) {
    DetectionsTable table;
    Images images;
    for (;;) {
      const auto next = lines.next();
      if (!next) return tl::make_unexpected(next.error());
      if (!*next) break;
      line_ = lines.number();
      std::string_view line = **next;
      if (line_ == 1) {
        if (const auto foreign = foreign_encoding(line); !foreign.empty()) {
          return fail(Cause::csv, "{}: {}", name_, foreign);
        }
        if (line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
      }
      if (auto taken = take_line(trimmed(line), table, images); !taken) {
        return tl::make_unexpected(taken.error());
      }
    }
    if (columns_.count == 0) {
      return fail(Cause::csv, "{}: empty; its first row must name the columns", name_);
    }
    table.images.reserve(images.size());
    for (auto& [key, detections] : images) {
      std::sort(detections.begin(), detections.end(), comes_before);
      table.images.push_back({key.first, key.second, std::move(detections)});
    }
    table.misordered = static_cast<int>(orders_.misordered());
    if (const auto doubt = doubt_of_table(table, orders_, monotonic)) {
      return fail(doubt->cause, "{}: {}", name_, doubt->text);
    }
    if (auto moved = move_edges_on(rig_, catalog_, name_, table); !moved) {
      return tl::make_unexpected(moved.error());
    }
    return table;
  }

 private:
  template <typename... Args>
  [[nodiscard]] tl::unexpected<Error> bad_row(fmt::format_string<Args...> format,
                                              Args&&... args) const {
    return fail(Cause::csv, "{}: line {}: {}", name_, line_,
                fmt::format(format, std::forward<Args>(args)...));
  }

  using Images = std::map<std::pair<Stamp, int>, std::vector<Detection>>;

  Status take_line(std::string_view line, DetectionsTable& table, Images& images) {
    if (line.empty()) return {};
    if (line.starts_with(kEdgeLinePrefix)) return read_edge_line(line, table);
    if (line.starts_with('#')) return read_own_line(line, table);
    const bool few_enough = split_at_commas(line, fields_);
    if (columns_.count == 0) {
      if (const auto foreign = foreign_header(line); !foreign.empty())
        return bad_row("{}", foreign);
    }
    if (!few_enough) return bad_row("more than {} columns", kMostColumns);
    if (columns_.count == 0) return read_header(line);
    auto row = read_row();
    if (!row) return tl::make_unexpected(row.error());
    std::vector<Detection>& image = images[{row->stamp, row->camera}];
    if (row->detection) image.push_back(std::move(*row->detection));
    if (row->unknown_marker) {
      ++table.unknown_markers;
      if (!catalog_.ignores(*row->unknown_marker)) ++table.unlisted[*row->unknown_marker];
    }
    return {};
  }

  static bool comes_before(const Detection& a, const Detection& b) {
    if (a.marker != b.marker) return a.marker < b.marker;
    for (std::size_t i = 0; i < a.corners.size(); ++i) {
      for (const Eigen::Index axis : {0, 1}) {
        if (a.corners[i][axis] != b.corners[i][axis]) {
          return a.corners[i][axis] < b.corners[i][axis];
        }
      }
    }
    return a.hamming < b.hamming;
  }

  /// `# detector=NAME markers=FINGERPRINT`, as format_detections_csv writes it; any other comment
  /// is passed over.
  Status read_own_line(std::string_view line, DetectionsTable& table) const {
    const auto key = line.find(kFingerprintKey);
    if (!line.starts_with(kOwnLinePrefix) || key == std::string_view::npos) return {};
    table.detector = line.substr(kOwnLinePrefix.size(), key - kOwnLinePrefix.size());
    table.markers_fingerprint = trimmed(line.substr(key + kFingerprintKey.size()));
    if (table.markers_fingerprint != catalog_.fingerprint()) {
      return fail(ErrorKind::bad_data,
                  "{}: stale: it was detected for other markers than markers.toml names now; "
                  "detect again (--redetect) or delete it",
                  name_);
    }
    return {};
  }

  Status read_edge_line(std::string_view line, DetectionsTable& table) const {
    const auto read = parse_edge_line(line);
    if (!read)
      return bad_row("{} is neither \"{}CAMERA bias_px=… sigma_px=… response=…\" nor moved_px=…",
                     line.substr(0, kQuotedHeader), kEdgeLinePrefix);
    for (std::size_t c = 0; c < rig_.cameras.size(); ++c) {
      if (rig_.cameras[c].name != read->camera) continue;
      table.moves.resize(rig_.cameras.size());
      if (table.moves[c]) return bad_row("a second line on the edges of {}", read->camera);
      table.moves[c] = read->move;
      return {};
    }
    return bad_row("camera \"{}\" is not in rig.yaml", read->camera);
  }

  Status read_header(std::string_view line) {
    std::map<std::string_view, std::size_t> places;
    std::string_view doubled;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      if (!fields_[i].empty() && !places.emplace(fields_[i], i).second) doubled = fields_[i];
    }
    std::string_view missing;
    const auto place = [&](std::string_view column, bool required) {
      const auto found = places.find(column);
      if (found != places.end()) return found->second;
      if (required && missing.empty()) missing = column;
      return Columns::kAbsent;
    };
    columns_.t_ns = place("t_ns", true);
    columns_.camera = place("camera", true);
    columns_.marker_id = place("marker_id", true);
    columns_.hamming = place("hamming", false);
    columns_.family = place("family", false);
    for (std::size_t i = 0; i < kCornerColumns.size(); ++i) {
      columns_.corners[i] = place(kCornerColumns[i], true);
    }
    const bool any_covariance =
        std::any_of(kCovarianceColumns.begin(), kCovarianceColumns.end(),
                    [&](std::string_view column) { return places.contains(column); });
    for (std::size_t i = 0; i < kCovarianceColumns.size(); ++i) {
      columns_.covariances[i] = place(kCovarianceColumns[i], any_covariance);
    }
    if (!missing.empty()) {
      return bad_row(
          "no column \"{}\"; the columns are t_ns,camera,marker_id,x0,y0,…,x3,y3, here {}", missing,
          line.substr(0, kQuotedHeader));
    }
    if (!doubled.empty()) return bad_row("column \"{}\" stands twice", doubled);
    columns_.count = fields_.size();
    return {};
  }

  /// From t_ns; how other programs write times is told apart.
  Expected<Stamp> read_stamp() const {
    const std::string_view field = fields_[columns_.t_ns];
    const auto t_ns = parse_whole<std::int64_t>(field);
    if (t_ns && is_in_range(Stamp(*t_ns))) return Stamp(*t_ns);
    return fail(
        Cause::stamps, "{}: line {}: t_ns \"{}\" {}", name_, line_, field,
        t_ns ? "is further than 146 years from any epoch; it counts ns" : why_no_stamp(field));
  }

  Expected<Row> read_row() {
    if (fields_.size() != columns_.count) {
      const bool decimal_commas = fields_.size() == columns_.count + kCornerColumns.size();
      return bad_row("{} fields where the header names {}; {}", fields_.size(), columns_.count,
                     decimal_commas ? "decimal commas? Write points" : "is the file cut off?");
    }
    Row row;
    const auto stamp = read_stamp();
    if (!stamp) return tl::make_unexpected(stamp.error());
    row.stamp = *stamp;
    const auto camera = std::find_if(
        rig_.cameras.begin(), rig_.cameras.end(),
        [&](const RigCamera& known) { return known.name == fields_[columns_.camera]; });
    if (camera == rig_.cameras.end()) {
      return bad_row("camera \"{}\" is not in rig.yaml", fields_[columns_.camera]);
    }
    row.camera = static_cast<int>(std::distance(rig_.cameras.begin(), camera));
    if (fields_[columns_.marker_id].empty()) return row;

    const auto marker = read_marker();
    if (!marker) return tl::make_unexpected(marker.error());
    Detection detection;
    detection.marker = *marker;
    if (const auto status = read_corners(detection); !status) {
      return tl::make_unexpected(status.error());
    }
    if (const auto status = read_covariances(detection); !status) {
      return tl::make_unexpected(status.error());
    }
    if (columns_.hamming != Columns::kAbsent && !fields_[columns_.hamming].empty()) {
      const auto hamming = parse_whole<int>(fields_[columns_.hamming]);
      if (!hamming || *hamming < 0) {
        return bad_row("hamming \"{}\" is no count of bits", fields_[columns_.hamming]);
      }
      detection.hamming = *hamming;
    }
    if (!catalog_.size_m(detection.marker)) {
      row.unknown_marker = detection.marker;
      return row;
    }
    if (orders_.add(detection.corners)) row.detection = detection;
    return row;
  }

  /// From marker_id ("12" or "tag36h11:12") and, where there is one, the family column.
  Expected<MarkerId> read_marker() const {
    std::optional<Family> family = only_family_;
    const std::string_view stated =
        columns_.family == Columns::kAbsent ? std::string_view{} : fields_[columns_.family];
    if (!stated.empty()) {
      family = family_from_name(stated);
      if (!family) return bad_row("unknown family \"{}\"", stated);
    }
    const auto marker = parse_marker_id(fields_[columns_.marker_id], family);
    if (!marker) return bad_row("{}", marker.error().message);
    if (!stated.empty() && marker->family != *family) {
      return bad_row("marker id \"{}\" contradicts its family column, \"{}\"",
                     fields_[columns_.marker_id], stated);
    }
    return *marker;
  }

  Status read_corners(Detection& detection) const {
    for (std::size_t i = 0; i < columns_.corners.size(); ++i) {
      const std::string_view field = fields_[columns_.corners[i]];
      const auto value_px = parse_whole<double>(field);
      if (!value_px || !(std::abs(*value_px) <= kMaxCorner_px)) {
        return bad_row("{} \"{}\" is no pixel coordinate", kCornerColumns[i], field);
      }
      detection.corners[i / 2][static_cast<Eigen::Index>(i % 2)] = *value_px;
    }
    return {};
  }

  /// A row may leave all twelve fields empty.
  Status read_covariances(Detection& detection) const {
    if (!columns_.has_covariances()) return {};
    const auto empty = [&](std::size_t column) { return fields_[column].empty(); };
    if (std::all_of(columns_.covariances.begin(), columns_.covariances.end(), empty)) return {};
    std::array<double, 12> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::string_view field = fields_[columns_.covariances[i]];
      const auto value = parse_whole<double>(field);
      if (!value || !std::isfinite(*value)) {
        return bad_row("{} \"{}\" is no number", kCovarianceColumns[i], field);
      }
      values[i] = *value;
    }
    CornerCovariances& covariances = detection.covariances.emplace();
    for (std::size_t corner = 0; corner < covariances.size(); ++corner) {
      const double sxx = values[3 * corner];
      const double sxy = values[3 * corner + 1];
      const double syy = values[3 * corner + 2];
      if (!(sxx > 0 && syy > 0 && sxx * syy - sxy * sxy > 0)) {
        return bad_row(
            "the covariance of corner {} (sxx {}, sxy {}, syy {}) is not positive definite", corner,
            sxx, sxy, syy);
      }
      covariances[corner] << sxx, sxy, sxy, syy;
    }
    return {};
  }

  const std::string& name_;
  const Rig& rig_;
  const MarkerCatalog& catalog_;
  std::optional<Family> only_family_;
  Columns columns_;
  std::size_t line_ = 0;
  CornerOrders orders_;
  std::vector<std::string_view> fields_;  ///< of the present line
};

}  // namespace

Expected<DetectionsTable> read_detections_csv(const std::filesystem::path& path, const Rig& rig,
                                              const MarkerCatalog& catalog, bool monotonic) {
  auto file = InputFile::open(path, kLargestFile);
  if (!file) return tl::make_unexpected(file.error());
  const std::string name = path.string();
  LineReader lines(std::move(*file), name, kLongestLine);
  return Reader(name, rig, catalog).read(lines, monotonic);
}

}  // namespace waymark
