#pragma once

#include <filesystem>
#include <string>

#include "core/base/error.h"
#include "simulator/capture_plan.h"
#include "simulator/rig_library.h"
#include "simulator/scene.h"

namespace waymark::simulator {

/// A capture folder in the making: it grows beside its final place and moves there when it is
/// whole, so that nobody reads half a capture and an existing one is never touched.
class CaptureOutput {
 public:
  /// cant_create when `final_path` exists and is not an empty folder, or its parent can't be
  /// written.
  [[nodiscard]] static Expected<CaptureOutput> begin(const std::filesystem::path& final_path);

  CaptureOutput(CaptureOutput&& other) noexcept;
  CaptureOutput(const CaptureOutput&) = delete;
  CaptureOutput& operator=(const CaptureOutput&) = delete;
  CaptureOutput& operator=(CaptureOutput&&) = delete;
  /// Removes what was written unless finish() moved it to its place.
  ~CaptureOutput();

  /// Where files of the capture are written now.
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  /// rig.yaml, markers.toml, capture.toml, frames.csv and groundtruth/.
  /// Transforms are left out of rig.yaml when the rig is mono; then groundtruth/ also has
  /// rig.camN.tum (world_from_cam).
  [[nodiscard]] Status write_description(const Scene& scene, const SimulatedRig& rig,
                                         const CapturePlan& plan, double exposure_s,
                                         const std::string& session) const;

  [[nodiscard]] Status finish();

 private:
  CaptureOutput(std::filesystem::path final_path, std::filesystem::path folder)
      : final_path_(std::move(final_path)), folder_(std::move(folder)) {}

  std::filesystem::path final_path_;
  std::filesystem::path folder_;  ///< empty once finished or moved from
};

/// Creates a folder; cant_create or permission with the reason.
[[nodiscard]] Status create_folder(const std::filesystem::path& path);

}  // namespace waymark::simulator
