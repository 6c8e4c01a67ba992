#pragma once

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/error.h"

namespace waymark {

/// Where locd listens: `control` in RUNTIME_DIRECTORY, or in /run/locd.
[[nodiscard]] std::filesystem::path default_control_socket();

/// Makes one request of the locd that listens at `socket`, and waits for its answer: the members of
/// the JSON object that it gives, "ok" apart. Errors: unavailable (no locd listens there, it turned
/// the request away, it ended), permission (not a member of its group), kNoAnswer (none within
/// `patience`), bad_data (what answers is no locd of this version); and whatever locd refuses, with
/// its code and text.
[[nodiscard]] Expected<nlohmann::ordered_json> ask_locd(const std::filesystem::path& socket,
                                                        const std::string& request,
                                                        std::chrono::milliseconds patience);

}  // namespace waymark
