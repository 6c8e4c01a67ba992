#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/toml_text.h"

namespace waymark {

/// The fields of one TOML table, read one after the other; the first thing that is wrong is kept
/// and everything after it yields zeros, so that a reader states its fields and asks once.
class TomlFields {
 public:
  TomlFields(const toml::table& table, std::string name, ErrorKind error = ErrorKind::bad_data)
      : table_(table), name_(std::move(name)), error_(error) {}

  /// A finite number in [low, high]; `fallback` when absent, an error when there is none.
  double number(std::string_view key, double low, double high,
                std::optional<double> fallback = std::nullopt);
  int integer(std::string_view key, int low, int high, std::optional<int> fallback = std::nullopt);
  bool boolean(std::string_view key, std::optional<bool> fallback = std::nullopt);
  /// Without a NUL, at which names of files would end.
  std::string text(std::string_view key, std::optional<std::string> fallback = std::nullopt);
  /// One of `choices`: its index.
  std::size_t choice(std::string_view key, std::initializer_list<std::string_view> choices,
                     std::optional<std::size_t> fallback = std::nullopt);
  /// Exactly `count` finite numbers; at least one when `count` is 0.
  std::vector<double> numbers(std::string_view key, std::size_t count,
                              std::optional<std::vector<double>> fallback = std::nullopt);
  Eigen::Vector3d vector3(std::string_view key,
                          std::optional<Eigen::Vector3d> fallback = std::nullopt);
  /// The [[key]] blocks, or { } entries of an array; none when absent.
  std::vector<const toml::table*> tables(std::string_view key);
  /// The [key] block; nullptr when absent.
  const toml::table* table(std::string_view key);

  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }

  /// A key that is read elsewhere.
  void allow(std::string_view key) { known_.emplace_back(key); }

  /// Notes that the table makes no sense for a reason of the reader's own.
  void reject(const std::string& why);
  /// The same of one key's value.
  void reject(std::string_view key, const std::string& why);
  /// Takes the error of a reader called in between.
  void reject(const Error& error);

  /// The first error, also for a key that no call above has asked for.
  [[nodiscard]] Status finish();

 private:
  const toml::node* find(std::string_view key);
  void reject_at(const toml::node& node, const std::string& why);

  const toml::table& table_;
  std::string name_;
  ErrorKind error_;
  std::vector<std::string> known_;
  std::optional<Error> first_error_;
};

}  // namespace waymark
