#pragma once

#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "core/base/error.h"

namespace waymark {

/// `mapbuilder print --family F --ids 0-199 --size-m 0.16 [--paper a4|a3|letter|WxH] -o FILE.pdf`;
/// family and size once for all ids, or as often as ids.
struct PrintOptions {
  std::vector<std::string> families;
  std::vector<std::string> ids;
  std::vector<double> sizes_m;
  std::string paper = "a4";
  std::filesystem::path output;
};

/// `mapbuilder print --advise --rig RIG.yaml --range-m 8`
struct PrintAdviceOptions {
  bool asked = false;
  std::filesystem::path rig;
  std::optional<double> range_m;
};

/// Writes the markers as a PDF, and markers.toml beside it; where one lies there already it stays,
/// and must state the same sizes for what is printed. Errors: usage (an unknown family, ids outside
/// of it, none or twice, sizes outside 0.005–5 m, as many families or sizes as fit no ids);
/// bad_data where markers.toml says otherwise; those of write_file_atomically.
[[nodiscard]] Status run_print(const PrintOptions& options, std::ostream& out);

/// Says which size the rig's cameras need, and in `notes` what is to be told of its file. usage for
/// a range outside kAdviceRange_m; errors of reading the rig.
[[nodiscard]] Status run_print_advice(const PrintAdviceOptions& options, std::ostream& out,
                                      std::ostream& notes);

}  // namespace waymark
