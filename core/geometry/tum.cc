#include "core/geometry/tum.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "core/base/atomic_file.h"
#include "core/base/text_field.h"

namespace waymark {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::string_view kWhiteSpace = " \t\r";
/// Ten million poses.
constexpr std::size_t kMaxBytes = std::size_t{1} << 30;
/// As of markers in maps.
constexpr double kMaxPosition_m = 1e6;

/// A line's fields between white space; the comment after a `#` is no field.
struct Fields {
  std::array<std::string_view, 8> texts;  ///< the first of them
  std::size_t count = 0;
};

Fields fields_of(std::string_view line) {
  line = line.substr(0, line.find('#'));
  Fields fields;
  for (;; ++fields.count) {
    const std::size_t begin = line.find_first_not_of(kWhiteSpace);
    if (begin == std::string_view::npos) return fields;
    line.remove_prefix(begin);
    const std::size_t end = std::min(line.find_first_of(kWhiteSpace), line.size());
    if (fields.count < fields.texts.size()) fields.texts[fields.count] = line.substr(0, end);
    line.remove_prefix(end);
  }
}

/// A finite decimal number that fills the whole text, '+' allowed.
std::optional<double> number_from(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto value = parse_whole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

Expected<TumPose> pose_from(const Fields& fields) {
  if (fields.count != fields.texts.size()) {
    return fail(ErrorKind::bad_data, "{} fields instead of 8 (key tx ty tz qx qy qz qw)",
                fields.count);
  }
  std::array<double, 7> v{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const auto value = number_from(fields.texts[i + 1]);
    if (!value) return fail(ErrorKind::bad_data, "'{}' is no finite number", fields.texts[i + 1]);
    v[i] = *value;
    if (i < 3 && std::abs(v[i]) > kMaxPosition_m) {
      return fail(ErrorKind::bad_data, "position of {} m, beyond 1000 km; positions are in metres",
                  fields.texts[i + 1]);
    }
  }
  const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
  if (!(std::abs(rotation.norm() - 1) <= 0.01)) {
    return fail(ErrorKind::bad_data, "quaternion of norm {:.6g} instead of 1", rotation.norm());
  }
  return TumPose{std::string(fields.texts[0]),
                 {rotation.normalized(), Eigen::Vector3d(v[0], v[1], v[2])}};
}

}  // namespace

Expected<std::vector<TumPose>> read_tum(const std::filesystem::path& path) {
  const auto text = read_file(path, kMaxBytes);
  if (!text) return tl::make_unexpected(text.error());
  return parse_tum(*text, path.string());
}

Expected<std::vector<TumPose>> parse_tum(std::string_view text, const std::string& name) {
  std::vector<TumPose> poses;
  std::string_view rest = text;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
  for (int line_number = 1; !rest.empty(); ++line_number) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const auto fields = fields_of(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (fields.count == 0) continue;
    auto pose = pose_from(fields);
    if (!pose) {
      return fail(ErrorKind::bad_data, "{}: line {}: {}", name, line_number, pose.error().message);
    }
    poses.push_back(*std::move(pose));
  }
  return poses;
}

std::string format_tum(const std::vector<TumPose>& poses) {
  std::string text;
  for (const TumPose& p : poses) {
    const Eigen::Vector3d& t = p.pose.translation;
    const Eigen::Quaterniond& q = p.pose.rotation;
    fmt::format_to(std::back_inserter(text),
                   "{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", p.key, t.x(), t.y(),
                   t.z(), q.x(), q.y(), q.z(), q.w());
  }
  return text;
}

std::string format_stamp_s(Stamp stamp) {
  // Unsigned, because the magnitude of the most negative stamp is no int64.
  const bool negative = stamp.count() < 0;
  const auto magnitude = negative ? std::uint64_t{0} - static_cast<std::uint64_t>(stamp.count())
                                  : static_cast<std::uint64_t>(stamp.count());
  return fmt::format("{}{}.{:09}", negative ? "-" : "", magnitude / kNsPerSecond,
                     magnitude % kNsPerSecond);
}

Expected<Stamp> parse_stamp_s(std::string_view text) {
  const auto no_stamp = [&] {
    return fail(ErrorKind::bad_data, "'{}' is no time in seconds within ±9.2e9", text);
  };
  std::string_view digits = text;
  const bool negative = digits.starts_with('-');
  if (negative || digits.starts_with('+')) digits.remove_prefix(1);
  const std::size_t point = std::min(digits.find('.'), digits.size());
  const std::string_view whole = digits.substr(0, point);
  std::string fraction(digits.substr(std::min(point + 1, digits.size())));
  const auto all_digits = [](std::string_view part) {
    return part.find_first_not_of("0123456789") == std::string_view::npos;
  };
  if (whole.size() + fraction.size() == 0 || !all_digits(whole) || !all_digits(fraction)) {
    return no_stamp();
  }
  const bool round_up = fraction.size() > 9 && fraction[9] >= '5';
  fraction.resize(9, '0');
  const auto seconds = parse_whole<std::int64_t>(whole.empty() ? "0" : whole);
  const auto nanoseconds = parse_whole<std::int64_t>(fraction);
  if (!seconds || *seconds > 9'200'000'000) return no_stamp();
  const std::int64_t total = *seconds * kNsPerSecond + *nanoseconds + (round_up ? 1 : 0);
  return Stamp(negative ? -total : total);
}

}  // namespace waymark
