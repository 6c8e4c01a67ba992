#pragma once

#include <gtest/gtest.h>

#include <string_view>

#include "core/camera/kalibr.h"
#include "core/capture/detections_csv.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark::test {

/// Reads detections.csv beside a rig of two cameras.
class CsvOfTwoCameras : public testing::Test {
 protected:
  [[nodiscard]] Expected<DetectionsTable> read(std::string_view text) const {
    return read_detections_csv(folder_.write("detections.csv", text), rig_, catalog_);
  }

  [[nodiscard]] DetectionsTable good(std::string_view text) const {
    auto table = read(text);
    EXPECT_TRUE(table) << table.error().message;
    return table ? *table : DetectionsTable();
  }

  TemporaryFolder folder_;
  Rig rig_ = parse_camchain(tiny_rig_yaml(2), "rig.yaml")->rig;
  MarkerCatalog catalog_ = *parse_marker_catalog(tiny_markers_toml(), "markers.toml");
};

}  // namespace waymark::test
