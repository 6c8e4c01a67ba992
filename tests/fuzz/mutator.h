#pragma once

#include <random>
#include <string>
#include <vector>

namespace waymark::test {

/// Damages valid inputs the way bad disks, cut transfers, editors and attackers do; `words` are the
/// form's own. Seeded.
class Mutator {
 public:
  Mutator(std::vector<std::string> seeds, std::vector<std::string> words, std::uint32_t seed)
      : seeds_(std::move(seeds)), words_(std::move(words)), random_(seed) {
    words_.insert(words_.end(), std::begin(kNasty), std::end(kNasty));
  }

  /// One of the seeds with one to eight damages.
  [[nodiscard]] std::string next() {
    std::string text = seeds_[below(seeds_.size())];
    for (std::size_t damages = 1 + below(8); damages > 0; --damages) damage(text);
    return text;
  }

 private:
  std::size_t below(std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random_);
  }

  void damage(std::string& text) {
    if (text.empty()) text.push_back('x');
    const std::size_t at = below(text.size());
    const std::size_t length = 1 + below(std::min<std::size_t>(32, text.size() - at));
    switch (below(9)) {
      case 0:
        text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
        break;
      case 1:
        text[at] = static_cast<char>(below(256));
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(at, text.substr(below(text.size()), length));
        break;
      case 4:
        text.resize(at);
        break;
      case 5:
        text.replace(at, length, words_[below(words_.size())]);
        break;
      case 6:  // nested beyond any stack
        text.insert(at, repeated(kNesting[below(std::size(kNesting))], 1 + below(4000)));
        break;
      case 7:  // four bytes that are a size, a count or an offset somewhere
        for (std::size_t i = at; i < std::min(at + 4, text.size()); ++i) {
          text[i] = static_cast<char>(i == at ? 0x7f : 0xff);
        }
        break;
      default: {
        const std::string& other = seeds_[below(seeds_.size())];
        text = text.substr(0, at) + other.substr(std::min(at, other.size()));
        break;
      }
    }
  }

  static std::string repeated(const char* text, std::size_t times) {
    std::string all;
    for (std::size_t i = 0; i < times; ++i) all += text;
    return all;
  }

  static constexpr const char* kNesting[] = {"[", "{", "{\"a\":", "[{a = ", "a.", "- ", "? ", "("};
  static constexpr const char* kNasty[] = {"nan",        "-inf",
                                           "1e999",      "-1",
                                           "0",          "18446744073709551616",
                                           "4294967295", "[[[[[[[[[[[[[[[[",
                                           "{",          "}",
                                           "\"",         "\\",
                                           "\n",         "\r\n",
                                           "# ",         "../../etc/passwd",
                                           "%s%n",       "\xff\xfe",
                                           "&a *a",      "!!",
                                           "4294967308", "12.7",
                                           "\u202e",     "\x1b[2J"};

  std::vector<std::string> seeds_;
  std::vector<std::string> words_;
  std::mt19937 random_;
};

}  // namespace waymark::test
