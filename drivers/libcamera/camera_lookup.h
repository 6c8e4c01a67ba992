#pragma once

#include <libcamera/camera_manager.h>

#include <memory>
#include <string>

#include "core/base/error.h"
#include "drivers/v4l2/video_node.h"

namespace waymark {

/// libcamera allows one manager per process: all cameras share it, the first one starts it.
/// unavailable when it can't.
[[nodiscard]] Expected<std::shared_ptr<libcamera::CameraManager>> shared_manager();

/// Gives back a share; with the last the manager ends, and the next one looks for cameras anew.
void let_go(std::shared_ptr<libcamera::CameraManager>& manager);

/// The camera to which a node of Video4Linux belongs; null: none of libcamera's.
[[nodiscard]] std::shared_ptr<libcamera::Camera> camera_of(libcamera::CameraManager& manager,
                                                           const std::string& node);

/// The first node of Video4Linux that captures a camera's images; empty: none that we may open.
[[nodiscard]] std::string capture_node_of(const std::shared_ptr<libcamera::Camera>& camera,
                                          libcamera::CameraManager& manager, VideoSystem& system);

/// What its maker calls it.
[[nodiscard]] std::string model_of(const libcamera::Camera& camera);

/// What one of libcamera's calls says by a negative errno.
[[nodiscard]] std::string reason(int negative_errno);

}  // namespace waymark
