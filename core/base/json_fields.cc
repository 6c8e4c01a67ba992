#include "core/base/json_fields.h"

#include <algorithm>

namespace waymark {

using nlohmann::json;

namespace {

/// nullopt: no whole number, or none that fits.
std::optional<std::int64_t> whole_number(const json& value) {
  if (value.is_number_unsigned()) {  // the parser's kind for all that have no minus
    const auto number = value.get<std::uint64_t>();
    constexpr std::uint64_t kLargest = std::numeric_limits<std::int64_t>::max();
    return number <= kLargest ? std::optional(static_cast<std::int64_t>(number)) : std::nullopt;
  }
  return value.is_number_integer() ? std::optional(value.get<std::int64_t>()) : std::nullopt;
}

}  // namespace

JsonFields::JsonFields(const json& value, const std::string& name, std::string place)
    : object_(value), name_(name), place_(std::move(place)) {
  if (!object_.is_object()) reject("is no object");
}

Error JsonFields::error_at(std::string_view key, std::string_view why) const {
  std::string place = place_;
  if (!key.empty()) place += (place.empty() ? "" : ".") + std::string(key);
  return {ErrorKind::bad_data,
          fmt::format("{}: {}: {}", name_, place.empty() ? "top level" : place, why)};
}

void JsonFields::reject_at(std::string_view key, std::string_view why) {
  if (good()) first_error_ = error_at(key, why);
}

const json* JsonFields::find(std::string_view key, bool needed) {
  known_.push_back(key);
  if (!good()) return nullptr;
  const auto found = object_.find(key);
  if (found != object_.end()) return &*found;
  if (needed) missing_ = error_at("", fmt::format("\"{}\" is missing", key));
  return nullptr;
}

double JsonFields::number(std::string_view key, double low, double high,
                          std::optional<double> fallback) {
  const json* const found = find(key, !fallback);
  if (found == nullptr) return fallback.value_or(0);
  if (!found->is_number()) {
    reject(key, "is no number");
    return 0;
  }
  const auto value = found->get<double>();
  if (value >= low && value <= high) return value;
  reject(key, fmt::format("{} is not within {} and {}", value, low, high));
  return 0;
}

std::int64_t JsonFields::integer(std::string_view key, std::int64_t low, std::int64_t high,
                                 std::optional<std::int64_t> fallback) {
  const json* const found = find(key, !fallback);
  if (found == nullptr) return fallback.value_or(0);
  const auto value = whole_number(*found);
  if (value && *value >= low && *value <= high) return *value;
  reject(key, fmt::format("is no whole number from {} to {}", low, high));
  return 0;
}

bool JsonFields::boolean(std::string_view key, std::optional<bool> fallback) {
  const json* const found = find(key, !fallback);
  if (found == nullptr) return fallback.value_or(false);
  if (found->is_boolean()) return found->get<bool>();
  reject(key, "is neither true nor false");
  return false;
}

std::string JsonFields::text(std::string_view key, const std::optional<std::string>& fallback) {
  const json* const found = find(key, !fallback);
  if (found == nullptr) return fallback.value_or("");
  if (found->is_string()) return found->get<std::string>();
  reject(key, "is no text");
  return "";
}

std::size_t JsonFields::choice(std::string_view key,
                               std::initializer_list<std::string_view> choices,
                               std::optional<std::size_t> fallback) {
  const json* const found = find(key, !fallback);
  if (found == nullptr) return fallback.value_or(0);
  const auto* const chosen =
      found->is_string() ? std::find(choices.begin(), choices.end(), found->get<std::string>())
                         : choices.end();
  if (chosen != choices.end()) return static_cast<std::size_t>(chosen - choices.begin());
  reject(key, fmt::format("is not one of \"{}\"", fmt::join(choices, "\", \"")));
  return 0;
}

std::vector<double> JsonFields::numbers(std::string_view key, std::size_t count) {
  std::vector<double> values(count, 0.0);
  const json* const found = find(key, true);
  if (found == nullptr) return values;
  if (!found->is_array() || found->size() != count) {
    reject(key, fmt::format("is no list of {} numbers", count));
    return values;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const json& element = (*found)[i];
    if (!element.is_number()) {
      reject(fmt::format("{}[{}]", key, i), "is no number");
      return values;
    }
    values[i] = element.get<double>();
  }
  return values;
}

std::vector<std::string> JsonFields::texts(std::string_view key) {
  std::vector<std::string> values;
  const json* const found = find(key, false);
  if (found == nullptr) return values;
  const auto is_text = [](const json& element) { return element.is_string(); };
  if (!found->is_array() || !std::all_of(found->begin(), found->end(), is_text)) {
    reject(key, "is no list of texts");
    return values;
  }
  for (const json& element : *found) values.push_back(element.get<std::string>());
  return values;
}

void JsonFields::each(std::string_view key, const std::function<void(JsonFields&)>& read) {
  const json* const found = find(key, true);
  if (found == nullptr) return;
  if (!found->is_array()) {
    reject(key, "is no list");
    return;
  }
  for (std::size_t i = 0; i < found->size(); ++i) {
    JsonFields element((*found)[i], name_,
                       fmt::format("{}{}{}[{}]", place_, place_.empty() ? "" : ".", key, i));
    read(element);
    if (const Status finished = element.finish(); !finished) {
      first_error_ = finished.error();
      return;
    }
  }
}

std::size_t JsonFields::count(std::string_view key) const {
  if (!object_.is_object()) return 0;
  const auto found = object_.find(key);
  return found != object_.end() && found->is_array() ? found->size() : 0;
}

const json* JsonFields::value(std::string_view key) { return find(key, false); }

std::vector<std::string> JsonFields::keys() const {
  std::vector<std::string> all;
  for (const auto& item : object_.items()) all.push_back(item.key());
  return all;
}

bool JsonFields::contains(std::string_view key) const { return object_.contains(key); }

bool JsonFields::has(std::string_view key) const {
  return contains(key) && !object_.find(key)->is_null();
}

Status JsonFields::status() const {
  if (first_error_) return tl::make_unexpected(*first_error_);
  return missing_ ? tl::make_unexpected(*missing_) : Status{};
}

Status JsonFields::finish() {
  if (first_error_) return status();
  for (const auto& [key, value] : object_.items()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    first_error_ = error_at(
        "", fmt::format("unknown key \"{}\"; known here: {}", key, fmt::join(known_, ", ")));
    break;
  }
  return status();
}

}  // namespace waymark
