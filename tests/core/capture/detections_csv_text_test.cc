#include "core/capture/detections_csv_text.h"

#include <gmock/gmock.h>

#include "tests/core/capture/csv_of_two_cameras.h"

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::Not;
using DetectionsCsvText = test::CsvOfTwoCameras;

TEST_F(DetectionsCsvText, WrittenTextReadsBackToTheSame) {
  const std::string covariances =
      ",sxx0,sxy0,syy0,sxx1,sxy1,syy1,sxx2,sxy2,syy2,sxx3,sxy3,syy3,hamming\n";
  const auto table =
      good("t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3" + covariances +
           "5,cam0,3,1.1234,1,2,1,2,2,1,2,0.01,0.00123456789,0.02,1,0,1,1,0,1,1e-6,-2e-7,1e-6,1\n"
           "6,cam1,,,,,,,,,,,,,,,,,,,,,,\n");
  ASSERT_TRUE(table.images[0].detections[0].covariances);
  EXPECT_EQ((*table.images[0].detections[0].covariances)[0](1, 0), 0.00123456789);

  const std::string text = format_detections_csv(table.images, rig_, catalog_, "opencv+lines/1");
  EXPECT_EQ(text.substr(0, text.find('\n')),
            "# detector=opencv+lines/1 markers=" + catalog_.fingerprint());
  const auto again = good(text);
  EXPECT_EQ(again.detector, "opencv+lines/1");
  ASSERT_EQ(again.images.size(), 2U);
  EXPECT_TRUE(again.images[1].detections.empty());
  const Detection& first = table.images[0].detections[0];
  const Detection& back = again.images[0].detections[0];
  EXPECT_EQ(back.marker, first.marker);
  EXPECT_EQ(back.hamming, 1);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(back.corners[i], first.corners[i]);
    EXPECT_EQ((*back.covariances)[i], (*first.covariances)[i]);
  }
  EXPECT_EQ(format_detections_csv(again.images, rig_, catalog_, "opencv+lines/1"), text);
}

TEST_F(DetectionsCsvText, HowCornersWereMovedFollowsTheFirstLineAndComesBack) {
  const DetectionsTable table =
      good("t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3\n5,cam0,3,1,1,2,1,2,2,1,2\n");
  EXPECT_TRUE(table.moves.empty());
  const EdgeMeasurement measured{0.25, 0.0125, SensorResponse::srgb};
  const std::string text =
      format_detections_csv(table.images, rig_, catalog_, "x", {{}, {0.25, measured}});
  EXPECT_TRUE(
      text.starts_with("# detector=x markers=" + catalog_.fingerprint() +
                       "\n# edges camera=cam0 moved_px=0\n"
                       "# edges camera=cam1 bias_px=0.2500 sigma_px=0.0125 response=srgb\nt_ns,"))
      << text;
  const DetectionsTable again = good(text);
  EXPECT_EQ(again.detector, "x");
  ASSERT_EQ(again.moves.size(), rig_.cameras.size());
  ASSERT_TRUE(again.moves[0]);
  EXPECT_FALSE(again.moves[0]->measured);
  ASSERT_TRUE(again.moves[1] && again.moves[1]->measured);
  EXPECT_EQ(again.moves[1]->measured->bias_px, 0.25);
  EXPECT_EQ(again.moves[1]->measured->response, SensorResponse::srgb);
  EXPECT_EQ(format_detections_csv(again.images, rig_, catalog_, "x"),
            format_detections_csv(table.images, rig_, catalog_, "x"));
}

// As it was before: lines on edges first, and none of cameras that were not measured.
TEST_F(DetectionsCsvText, EdgesMayComeFirst) {
  const std::string plain = format_detections_csv({}, rig_, catalog_, "x");
  const std::string line = "# edges camera=cam1 bias_px=0.2500 sigma_px=0.0125 response=open\n";
  const DetectionsTable table = good(line + plain);
  ASSERT_EQ(table.moves.size(), 2U);
  EXPECT_FALSE(table.moves[0]);
  EXPECT_TRUE(table.moves[1]);
}

TEST_F(DetectionsCsvText, TwoLinesOnOneCamerasEdgesAreRefused) {
  const std::string plain = format_detections_csv({}, rig_, catalog_, "x");
  const std::string measured = "# edges camera=cam1 bias_px=0.2 sigma_px=0.01 response=open\n";
  const std::string stated = "# edges camera=cam1 moved_px=0\n";
  for (const auto& [one, other] :
       {std::pair{measured, measured}, {measured, stated}, {stated, stated}}) {
    const auto table = read(plain + one + other);
    ASSERT_FALSE(table);
    EXPECT_EQ(table.error().exit_code(), 65);
    EXPECT_THAT(table.error().message, HasSubstr("a second line on the edges of cam1"));
  }
}

TEST_F(DetectionsCsvText, NeedleShapedCovariancesSurviveWriting) {
  std::vector<ImageDetections> images(1);
  images[0].detections.resize(1);
  Detection& detection = images[0].detections[0];
  detection.marker = {Family::tag36h11, 3};
  detection.corners = {{{1, 1}, {9, 1}, {9, 9}, {1, 9}}};
  // Two edges that cross at 1°: 10,000 times longer than wide.
  Eigen::Matrix2d needle;
  needle << 0.33333333333, 0.33330000000, 0.33330000000, 0.33333333333;
  detection.covariances.emplace().fill(needle);
  EXPECT_EQ(good(format_detections_csv(images, rig_, catalog_, "x")).images.size(), 1U);
}

TEST_F(DetectionsCsvText, CovariancesAreWrittenOnlyWhenEveryDetectionHasThem) {
  std::vector<ImageDetections> images(1);
  images[0].detections.resize(2);
  images[0].detections[0].covariances.emplace().fill(Eigen::Matrix2d::Identity());
  EXPECT_THAT(format_detections_csv(images, rig_, catalog_, "x"), Not(HasSubstr("sxx0")));
  images[0].detections[1].covariances = images[0].detections[0].covariances;
  EXPECT_THAT(format_detections_csv(images, rig_, catalog_, "x"), HasSubstr("sxx0"));
}

}  // namespace
}  // namespace waymark
