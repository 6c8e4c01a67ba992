#pragma once

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

namespace waymark::test {

/// A file with this content, for readers that take no text; the same name again and again, gone at
/// the program's end.
inline const std::filesystem::path& file_of(const std::string& content) {
  struct File {
    File()
        : path(std::filesystem::temp_directory_path() / ("fuzz-" + std::to_string(::getpid()))) {}
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    ~File() { std::remove(path.c_str()); }
    std::filesystem::path path;
  };
  static const File file;
  std::ofstream(file.path, std::ios::binary) << content;
  return file.path;
}

}  // namespace waymark::test
