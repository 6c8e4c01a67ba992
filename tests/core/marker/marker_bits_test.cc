#include "core/marker/marker_bits.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <opencv2/aruco/dictionary.hpp>

#include "mapbuilder/referees/apriltag_family.h"

namespace waymark {
namespace {

/// A grid of black (0) and white (1) cells, border and what is around it included.
using Cells = std::vector<std::uint8_t>;

Cells cells_of(const MarkerBits& bits) {
  return {bits.white.begin(), bits.white.begin() + bits.all_cells() * bits.all_cells()};
}

/// The middle of a picture that has one pixel per cell, without the white rim around it.
template <typename PixelAt>
Cells middle_cells(int picture_side, int cells, const PixelAt& pixel_at) {
  const int rim = (picture_side - cells) / 2;
  Cells white;
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      white.push_back(pixel_at(rim + row, rim + column) > 127 ? 1 : 0);
    }
  }
  return white;
}

Cells drawn_by_opencv(Family family, int number, int cells) {
  cv::Mat picture;
  cv::aruco::getPredefinedDictionary(static_cast<int>(family))
      ->drawMarker(number, cells, picture, 1);
  return middle_cells(cells, cells,
                      [&](int row, int column) { return picture.at<std::uint8_t>(row, column); });
}

TEST(MarkerBits, EveryArucoMarkerIsUprightAsOpenCvDrawsIt) {
  for (const FamilyTraits& family : all_families()) {
    if (family.family > Family::aruco_original) continue;
    // Drawing all 7,000 costs seconds; each family's first, last and every 17th do.
    for (int number = 0; number < family.id_count;
         number += number + 17 < family.id_count ? 17 : 1) {
      const MarkerBits bits = marker_bits({family.family, number});
      ASSERT_EQ(cells_of(bits), drawn_by_opencv(family.family, number, bits.cells))
          << family.name << ':' << number;
    }
  }
}

class AprilTagBits : public testing::TestWithParam<Family> {
 protected:
  ~AprilTagBits() override { apriltag_family(GetParam())->destroy(library_); }

  /// apriltag_to_image's picture of a tag.
  [[nodiscard]] Cells drawn_by_apriltag(int number, int cells) const {
    image_u8_t* const picture = apriltag_to_image(library_, static_cast<std::uint32_t>(number));
    Cells white = middle_cells(picture->width, cells, [&](int row, int column) {
      return picture->buf[row * picture->stride + column];
    });
    std::free(picture->buf);  // image_u8_destroy is not exported
    std::free(picture);
    return white;
  }

  apriltag_family_t* library_ = apriltag_family(GetParam())->create();
};

TEST_P(AprilTagBits, EveryTagIsUprightAsAprilTagDrawsIt) {
  const FamilyTraits& family = traits(GetParam());
  ASSERT_EQ(static_cast<int>(library_->ncodes), family.id_count);
  for (int number = 0; number < family.id_count; ++number) {
    const MarkerBits bits = marker_bits({family.family, number});
    ASSERT_EQ(bits.cells, library_->width_at_border);
    ASSERT_EQ(cells_of(bits), drawn_by_apriltag(number, bits.all_cells()))
        << family.name << ':' << number;
  }
}

/// Those that OpenCV has, too.
using OpenCvTagBits = AprilTagBits;

TEST_P(OpenCvTagBits, AreDrawnUpsideDownByIt) {
  const FamilyTraits& family = traits(GetParam());
  for (int number = 0; number < family.id_count; number += 5) {
    const MarkerBits bits = marker_bits({family.family, number});
    const Cells cells = cells_of(bits);
    const Cells backwards(cells.rbegin(), cells.rend());
    ASSERT_EQ(backwards, drawn_by_opencv(family.family, number, bits.cells)) << number;
  }
}

INSTANTIATE_TEST_SUITE_P(Families, OpenCvTagBits,
                         testing::Values(Family::tag16h5, Family::tag25h9, Family::tag36h10,
                                         Family::tag36h11),
                         [](const auto& info) { return std::string(name_of(info.param)); });

INSTANTIATE_TEST_SUITE_P(Families, AprilTagBits,
                         testing::Values(Family::tag16h5, Family::tag25h9, Family::tag36h10,
                                         Family::tag36h11, Family::tagstandard41h12,
                                         Family::tagstandard52h13, Family::tagcircle21h7,
                                         Family::tagcircle49h12, Family::tagcustom48h12),
                         [](const auto& info) { return std::string(name_of(info.param)); });

TEST(MarkerBits, TheSquaresBorderIsOfOneColourAndARingAroundItOfTheOther) {
  for (const FamilyTraits& family : all_families()) {
    const MarkerBits bits = marker_bits({family.family, 1});
    for (int i = 0; i < bits.cells; ++i) {
      EXPECT_EQ(bits.is_white(0, i), bits.is_light());
      EXPECT_EQ(bits.is_white(i, bits.cells - 1), bits.is_light());
      if (bits.outside == 0) continue;
      EXPECT_FALSE(bits.is_white(-1, i) || bits.is_white(i, bits.cells));
    }
    EXPECT_EQ(bits.is_light(), marker_layout(family.family).is_light());
  }
}

TEST(MarkerBits, ANegativeOfANegativeIsTheMarker) {
  for (const Family family : {Family::tag36h11, Family::tagcircle49h12}) {
    const MarkerBits bits = marker_bits({family, 5});
    const MarkerBits negative = negative_of(bits);
    EXPECT_NE(negative.is_light(), bits.is_light());
    EXPECT_EQ(negative.is_white(2, 2), !bits.is_white(2, 2));
    EXPECT_EQ(negative_of(negative).white, bits.white);
  }
}

TEST(MarkerBitsDeathTest, NumberOutsideTheFamilyIsABug) {
  EXPECT_DEATH((void)marker_bits({Family::tag16h5, 30}), "internal check failed");
  EXPECT_DEATH((void)marker_bits({Family::tag16h5, -1}), "internal check failed");
}

}  // namespace
}  // namespace waymark
