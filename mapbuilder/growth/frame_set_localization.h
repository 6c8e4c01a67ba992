#pragma once

#include <optional>
#include <span>
#include <vector>

#include "mapbuilder/bundle/prepared_observations.h"
#include "mapbuilder/growth/mapper_options.h"

namespace waymark {

/// Algorithm 1 for each of the frame sets, against the markers that are placed: by the accepted
/// observations, by all where none is accepted. From all candidates, unless the known pose,
/// refined, explains everything already. nullopt: it sees no placed marker, or no pose explains
/// what it sees.
[[nodiscard]] std::vector<std::optional<RigPoseEstimate>> solve_frame_sets(
    const PreparedObservations& prepared, const Estimate& estimate,
    std::span<const FrameSetIndex> frame_sets, const MapperOptions& options);

/// The estimate with these poses.
[[nodiscard]] Estimate localize(const PreparedObservations& prepared,
                                std::span<const FrameSetIndex> frame_sets,
                                const MapperOptions& options, Estimate estimate);

/// The frame sets that a joint adjustment leaves out, because fewer than two of their observations
/// are accepted and posed: those that have no pose yet among them.
[[nodiscard]] std::vector<FrameSetIndex> unadjusted_frame_sets(
    const Selection& selection, std::span<const FrameSetIndex> frame_sets,
    const Estimate& estimate);

}  // namespace waymark
