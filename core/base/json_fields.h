#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/json_text.h"

namespace waymark {

/// The fields of one JSON object, read one after the other, as TomlFields reads a table's: the
/// first thing that is wrong is kept and everything after it yields zeros, so that a reader states
/// its fields and asks once. Nothing is converted: a number in a text's place, a fraction in a
/// whole number's, a number out of range is wrong. Messages say where in the document
/// ("hall.json: submaps[0].markers[3].size_m: is no number"). Errors are bad_data.
class JsonFields {
 public:
  /// A document. `name` stands for the path in messages. What is no object is wrong.
  JsonFields(const nlohmann::json& document, const std::string& name)
      : JsonFields(document, name, "") {}

  /// A number in [low, high]; `fallback` when absent, an error when there is none.
  double number(std::string_view key, double low = std::numeric_limits<double>::lowest(),
                double high = std::numeric_limits<double>::max(),
                std::optional<double> fallback = std::nullopt);
  std::int64_t integer(std::string_view key, std::int64_t low, std::int64_t high,
                       std::optional<std::int64_t> fallback = std::nullopt);
  bool boolean(std::string_view key, std::optional<bool> fallback = std::nullopt);
  std::string text(std::string_view key, const std::optional<std::string>& fallback = std::nullopt);
  /// One of `choices`: its index.
  std::size_t choice(std::string_view key, std::initializer_list<std::string_view> choices,
                     std::optional<std::size_t> fallback = std::nullopt);
  /// Exactly `count` numbers.
  std::vector<double> numbers(std::string_view key, std::size_t count);
  /// A list of texts; none when absent.
  std::vector<std::string> texts(std::string_view key);
  /// Has each object of a list read, up to the first that is wrong; keys that `read` does not ask
  /// for are wrong there, too.
  void each(std::string_view key, const std::function<void(JsonFields&)>& read);
  /// How many elements the list has, for what must be reserved; 0 when there is none.
  [[nodiscard]] std::size_t count(std::string_view key) const;
  /// A value in a form that the reader looks at itself; nullptr when absent.
  const nlohmann::json* value(std::string_view key);

  /// Present, be it null.
  [[nodiscard]] bool contains(std::string_view key) const;
  /// Present, and not null.
  [[nodiscard]] bool has(std::string_view key) const;

  /// Of all members, for messages about a foreign form.
  [[nodiscard]] std::vector<std::string> keys() const;

  /// A key whose value is of no interest.
  void allow(std::string_view key) { known_.push_back(key); }

  /// Notes that the object makes no sense for a reason of the reader's own.
  void reject(std::string_view why) { reject_at("", why); }
  /// The same of one key's value.
  void reject(std::string_view key, std::string_view why) { reject_at(key, why); }

  /// Whether all was well so far.
  [[nodiscard]] bool good() const { return !first_error_ && !missing_; }
  /// The first error.
  [[nodiscard]] Status status() const;
  /// The first error, also for a key that no call above has asked for.
  [[nodiscard]] Status finish();

 private:
  JsonFields(const nlohmann::json& value, const std::string& name, std::string place);

  /// What stands under the key; nullptr when it is absent or all is wrong already. An absent one
  /// is an error where it is `needed`.
  const nlohmann::json* find(std::string_view key, bool needed);
  [[nodiscard]] Error error_at(std::string_view key, std::string_view why) const;
  void reject_at(std::string_view key, std::string_view why);

  const nlohmann::json& object_;
  const std::string& name_;
  std::string place_;  ///< in the document; empty at the top
  std::vector<std::string_view> known_;
  std::optional<Error> first_error_;
  std::optional<Error> missing_;  ///< a key that must be there; a misspelt one explains it better
};

}  // namespace waymark
