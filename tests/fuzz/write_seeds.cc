// Writes what libFuzzer starts from: FOLDER/NAME/0, 1, … and FOLDER/NAME.dict of every format.
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "tests/fuzz/format.h"

namespace {

/// As libFuzzer reads it: printable, in quotes.
std::string quoted(const std::string& word) {
  std::string text = "\"";
  for (const char c : word) {
    const auto code = static_cast<unsigned char>(c);
    const bool plain = code >= 0x20 && code < 0x7f && c != '"' && c != '\\';
    text += plain ? std::string(1, c) : fmt::format("\\x{:02x}", code);
  }
  return text + "\"\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: write_seeds FOLDER\n", stderr);
    return 64;
  }
  const std::filesystem::path folder = argv[1];
  for (const waymark::test::Format& format : waymark::test::formats()) {
    std::filesystem::create_directories(folder / format.name);
    for (std::size_t i = 0; i < format.seeds.size(); ++i) {
      std::ofstream(folder / format.name / std::to_string(i), std::ios::binary) << format.seeds[i];
    }
    std::ofstream dictionary(folder / (format.name + ".dict"), std::ios::binary);
    dictionary << "# " << format.name << '\n';  // libFuzzer refuses an empty one
    for (const std::string& word : format.words) dictionary << quoted(word);
  }
  return 0;
}
