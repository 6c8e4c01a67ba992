#include "core/base/toml_fields.h"

#include <algorithm>
#include <cmath>

namespace waymark {

const toml::node* TomlFields::find(std::string_view key) {
  known_.emplace_back(key);
  return table_.get(key);
}

void TomlFields::reject_at(const toml::node& node, const std::string& why) {
  if (!first_error_) {
    first_error_ = Error{error_, fmt::format("{}: {}", toml_place(name_, node), why)};
  }
}

void TomlFields::reject(const std::string& why) { reject_at(table_, why); }

void TomlFields::reject(std::string_view key, const std::string& why) {
  const toml::node* node = table_.get(key);
  reject_at(node != nullptr ? *node : table_, why);
}

void TomlFields::reject(const Error& error) {
  if (!first_error_) first_error_ = error;
}

double TomlFields::number(std::string_view key, double low, double high,
                          std::optional<double> fallback) {
  const toml::node* node = find(key);
  if (node == nullptr && fallback) return *fallback;
  const auto value = node != nullptr ? node->value<double>() : std::nullopt;
  if (!value || !(*value >= low && *value <= high)) {
    reject_at(node != nullptr ? *node : table_,
              fmt::format("{} must be a number from {} to {}", key, low, high));
    return fallback.value_or(low);
  }
  return *value;
}

int TomlFields::integer(std::string_view key, int low, int high, std::optional<int> fallback) {
  const toml::node* node = find(key);
  if (node == nullptr && fallback) return *fallback;
  const auto value =
      node != nullptr && node->is_integer() ? node->value<std::int64_t>() : std::nullopt;
  if (!value || *value < low || *value > high) {
    reject_at(node != nullptr ? *node : table_,
              fmt::format("{} must be a whole number from {} to {}", key, low, high));
    return fallback.value_or(low);
  }
  return static_cast<int>(*value);
}

bool TomlFields::boolean(std::string_view key, std::optional<bool> fallback) {
  const toml::node* node = find(key);
  if (node == nullptr && fallback) return *fallback;
  const auto* value = node != nullptr ? node->as_boolean() : nullptr;
  if (value == nullptr) {
    reject_at(node != nullptr ? *node : table_, fmt::format("{} must be true or false", key));
    return fallback.value_or(false);
  }
  return value->get();
}

std::string TomlFields::text(std::string_view key, std::optional<std::string> fallback) {
  const toml::node* node = find(key);
  if (node == nullptr && fallback) return *fallback;
  const auto value = node != nullptr ? node->value<std::string>() : std::nullopt;
  // What the system takes as a name ends at a NUL: another file would be meant.
  const bool whole = value && value->find('\0') == std::string::npos;
  if (!whole) reject_at(node != nullptr ? *node : table_, fmt::format("{} must be a text", key));
  return whole ? *value : "";
}

std::size_t TomlFields::choice(std::string_view key,
                               std::initializer_list<std::string_view> choices,
                               std::optional<std::size_t> fallback) {
  const toml::node* node = find(key);
  if (node == nullptr && fallback) return *fallback;
  const auto value = node != nullptr ? node->value<std::string>() : std::nullopt;
  const auto chosen = value ? std::find(choices.begin(), choices.end(), *value) : choices.end();
  if (chosen == choices.end()) {
    reject_at(node != nullptr ? *node : table_,
              fmt::format("{} must be one of \"{}\"", key, fmt::join(choices, "\", \"")));
    return fallback.value_or(0);
  }
  return static_cast<std::size_t>(chosen - choices.begin());
}

std::vector<double> TomlFields::numbers(std::string_view key, std::size_t count,
                                        std::optional<std::vector<double>> fallback) {
  const toml::node* node = find(key);
  if (node == nullptr && fallback) return *fallback;
  std::vector<double> values;
  if (node != nullptr && node->is_array()) {
    for (const toml::node& item : *node->as_array()) {
      const auto value = item.value<double>();
      if (value && std::isfinite(*value)) values.push_back(*value);
    }
  }
  const bool complete = node != nullptr && node->is_array() && !values.empty() &&
                        values.size() == node->as_array()->size() &&
                        (count == 0 || values.size() == count);
  if (complete) return values;
  reject_at(node != nullptr ? *node : table_,
            count == 0 ? fmt::format("{} must be an array of numbers", key)
                       : fmt::format("{} must be an array of {} numbers", key, count));
  return std::vector<double>(std::max<std::size_t>(count, 1), 0.0);
}

Eigen::Vector3d TomlFields::vector3(std::string_view key, std::optional<Eigen::Vector3d> fallback) {
  std::optional<std::vector<double>> plain;
  if (fallback) plain = {fallback->x(), fallback->y(), fallback->z()};
  const auto values = numbers(key, 3, std::move(plain));
  return {values[0], values[1], values[2]};
}

std::vector<const toml::table*> TomlFields::tables(std::string_view key) {
  const toml::node* node = find(key);
  std::vector<const toml::table*> found;
  if (node == nullptr) return found;
  if (!node->is_array_of_tables()) {
    reject_at(*node, fmt::format("{} must be [[{}]] blocks", key, key));
    return found;
  }
  for (const toml::node& item : *node->as_array()) found.push_back(item.as_table());
  return found;
}

const toml::table* TomlFields::table(std::string_view key) {
  const toml::node* node = find(key);
  if (node != nullptr && !node->is_table())
    reject_at(*node, fmt::format("{} must be a block", key));
  return node != nullptr ? node->as_table() : nullptr;
}

Status TomlFields::finish() {
  for (const auto& [key, node] : table_) {
    if (std::find(known_.begin(), known_.end(), key.str()) == known_.end()) {
      reject_at(node, fmt::format("unknown key \"{}\"; known here: {}", key.str(),
                                  fmt::join(known_, ", ")));
    }
  }
  if (first_error_) return tl::make_unexpected(*first_error_);
  return {};
}

}  // namespace waymark
