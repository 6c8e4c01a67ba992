#pragma once

#include <memory>
#include <vector>

#include "drivers/frame_source.h"
#include "locd/service/setup.h"

namespace waymark {

/// A source per camera of the rig, by the rig's order; no device is opened yet. Errors: config for
/// devices and formats that can't be meant; those of replayed captures; unavailable for a driver
/// that this build lacks.
[[nodiscard]] Expected<std::vector<std::unique_ptr<FrameSource>>> make_sources(const Setup& setup);

}  // namespace waymark
