#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>

namespace waymark {

/// How programs show their options: "--level still|drive REQUIRED", "--every INT (1 to 100)". What
/// CLI11 tells besides (how it checks and translates values, "ENUM:value in {huber->0}") is between
/// it and its callers; the description says which values there are. Only sources that link CLI11
/// include this.
class PlainHelp : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text;
    if (!option->get_type_name().empty()) text = " " + value_of(option->get_type_name());
    if (option->get_expected_max() > 1) text += " ...";
    if (!option->get_default_str().empty()) text += " = " + option->get_default_str();
    if (option->get_required()) text += " REQUIRED";
    return text;
  }

 private:
  /// What stands for a value of the type as CLI11 describes it: "INT:INT in [1 - 100]",
  /// "TEXT:{still,drive}", "ENUM:value in {huber->0} OR {0}".
  static std::string value_of(const std::string& type) {
    const auto colon = type.find(':');
    const std::string name = type.substr(0, colon);
    if (colon == std::string::npos) return name;
    std::string checks = type.substr(colon + 1);
    if (checks.front() == '{' && checks.back() == '}') {
      std::replace(checks.begin(), checks.end(), ',', '|');
      return checks.substr(1, checks.size() - 2);
    }
    const auto range = checks.find(" in [");
    const auto dash = checks.find(" - ", range);
    if (range == std::string::npos || dash == std::string::npos || checks.back() != ']') {
      return name == "ENUM" ? "TEXT" : name;
    }
    return name + " (" + checks.substr(range + 5, dash - range - 5) + " to " +
           checks.substr(dash + 3, checks.size() - dash - 4) + ")";
  }
};

}  // namespace waymark
