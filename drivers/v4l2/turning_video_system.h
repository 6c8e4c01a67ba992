#pragma once

#include <memory>

#include "drivers/turn_stamp.h"
#include "drivers/v4l2/video_node.h"

namespace waymark {

/// `system`, each of whose calls touches `turns` as it returns: to make many slow ones is to go on,
/// to be stuck in one is not. `turns` outlives it and its nodes.
[[nodiscard]] std::shared_ptr<VideoSystem> turning(std::shared_ptr<VideoSystem> system,
                                                   TurnStamp& turns);

}  // namespace waymark
