#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/toml_text.h"

namespace waymark::simulator {

/// The fields of one TOML table, read one after the other; the first thing that is wrong is kept
/// and everything after it yields zeros, so that a reader states its fields and asks once.
class TomlFields {
 public:
  TomlFields(const toml::table& table, std::string name) : table_(table), name_(std::move(name)) {}

  /// A finite number in [low, high]; `fallback` when absent, an error when there is none.
  double number(std::string_view key, double low, double high,
                std::optional<double> fallback = std::nullopt);
  int integer(std::string_view key, int low, int high, std::optional<int> fallback = std::nullopt);
  std::string text(std::string_view key, std::optional<std::string> fallback = std::nullopt);
  /// Exactly `count` finite numbers; at least one when `count` is 0.
  std::vector<double> numbers(std::string_view key, std::size_t count,
                              std::optional<std::vector<double>> fallback = std::nullopt);
  Eigen::Vector3d vector3(std::string_view key,
                          std::optional<Eigen::Vector3d> fallback = std::nullopt);
  /// The [[key]] blocks, or { } entries of an array; none when absent.
  std::vector<const toml::table*> tables(std::string_view key);
  /// The [key] block; nullptr when absent.
  const toml::table* table(std::string_view key);

  /// A key that is read elsewhere.
  void allow(std::string_view key) { known_.emplace_back(key); }

  /// Notes that the table makes no sense for a reason of the reader's own.
  void reject(const std::string& why);

  /// The first error, also for a key that no call above has asked for.
  [[nodiscard]] Status finish();

 private:
  const toml::node* find(std::string_view key);
  void reject_at(const toml::node& node, const std::string& why);

  const toml::table& table_;
  std::string name_;
  std::vector<std::string> known_;
  std::optional<Error> first_error_;
};

}  // namespace waymark::simulator
