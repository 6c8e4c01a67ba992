#include "core/map/map_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/small_map.h"

namespace waymark {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

SubMap one_marker() {
  SubMap submap = test::small_map().submaps[0];
  submap.markers = {submap.markers[0]};
  submap.markers[0].world_from_marker.translation = {1, 2, 3};
  return submap;
}

TEST(MapExport, TumHoldsIdsAndPoses) {
  EXPECT_EQ(
      format_submap_tum(one_marker(), false),
      "3 1.000000000 2.000000000 3.000000000 0.000000000 0.000000000 0.000000000 1.000000000\n");
  EXPECT_THAT(format_submap_tum(one_marker(), true), StartsWith("tag36h11:3 1.0"));
}

TEST(MapExport, CsvHoldsOneMarkerPerLine) {
  EXPECT_EQ(
      format_submap_csv(one_marker(), false),
      "id,family,size_m,stated_size_m,x_m,y_m,z_m,qx,qy,qz,qw,sigma_x_m,sigma_y_m,sigma_z_m,"
      "sigma_rx_rad,sigma_ry_rad,sigma_rz_rad,observations,rejected,rms_px,verified\n"
      "3,tag36h11,0.12,0.12,1.000000000,2.000000000,3.000000000,0.000000000,0.000000000,"
      "0.000000000,1.000000000,0.001,0.00141,0.00173,0.000632,0.000707,0.000775,13,1,0.2500,1\n");
}

TEST(MapExport, CsvLeavesUnknownDeviationsEmpty) {
  SubMap submap = one_marker();
  submap.markers[0].covariance = unknown_covariance();
  EXPECT_THAT(format_submap_csv(submap, false), HasSubstr("1.000000000,,,,,,,13,1,0.2500,1\n"));
}

TEST(MapExport, PlyHoldsASquarePerMarker) {
  const std::string text = format_submap_ply(one_marker());
  EXPECT_THAT(text, StartsWith("ply\nformat ascii 1.0\nelement vertex 4\n"));
  EXPECT_THAT(text, HasSubstr("element face 1\n"));
  // Top-left, top-right, bottom-right, bottom-left; the face runs the other way round.
  EXPECT_THAT(text, HasSubstr("end_header\n"
                              "0.940000000 2.060000000 3.000000000\n"
                              "1.060000000 2.060000000 3.000000000\n"
                              "1.060000000 1.940000000 3.000000000\n"
                              "0.940000000 1.940000000 3.000000000\n"
                              "4 0 3 2 1 3 1\n"));
}

}  // namespace
}  // namespace waymark
