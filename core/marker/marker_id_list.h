#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/marker/marker_id.h"

namespace waymark {

/// "100-199, 205" or "tag36h11:100-199, tag16h5:3": ids and ranges of them; a part without a family
/// is of `default_family`. Rising, each once. bad_data, naming the part that is at fault, for what
/// is no range, an unknown family, an id that its family does not have, and a part without a family
/// where several meet (nullopt).
[[nodiscard]] Expected<std::vector<MarkerId>> parse_marker_ids(
    std::string_view text, std::optional<Family> default_family);

/// "3-7, 9" or "tag36h11:3-7, tag36h11:9" from rising ids: at most `most` parts, then how many ids
/// there are in all.
[[nodiscard]] std::string format_marker_ids(std::span<const MarkerId> ids, bool with_family,
                                            std::size_t most = 30);

}  // namespace waymark
