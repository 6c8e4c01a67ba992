#include "core/marker/marker_bits.h"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <memory>
#include <opencv2/aruco/dictionary.hpp>
#include <ostream>

namespace waymark {
namespace {

/// A grid of black (0) and white (1) cells, border included.
using Cells = std::vector<std::uint8_t>;

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
    if (family.family >= Family::tag16h5) continue;
    // Drawing all 7,000 costs seconds; each family's first, last and every 17th do.
    for (int number = 0; number < family.id_count;
         number += number + 17 < family.id_count ? 17 : 1) {
      const MarkerBits bits = marker_bits({family.family, number});
      ASSERT_EQ(bits.cells, family.code_cells + 2);
      ASSERT_EQ(bits.white, drawn_by_opencv(family.family, number, bits.cells))
          << family.name << ':' << number;
    }
  }
}

/// One of libapriltag's families.
struct AprilTagFamily {
  Family family;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

std::ostream& operator<<(std::ostream& out, const AprilTagFamily& family) {
  return out << name_of(family.family);
}

class AprilTagBits : public testing::TestWithParam<AprilTagFamily> {
 protected:
  ~AprilTagBits() override { GetParam().destroy(library_); }

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

  apriltag_family_t* library_ = GetParam().create();
};

TEST_P(AprilTagBits, EveryTagIsUprightAsAprilTagDrawsIt) {
  const FamilyTraits& family = traits(GetParam().family);
  ASSERT_EQ(static_cast<int>(library_->ncodes), family.id_count);
  for (int number = 0; number < family.id_count; ++number) {
    const MarkerBits bits = marker_bits({family.family, number});
    ASSERT_EQ(bits.cells, library_->width_at_border);
    ASSERT_EQ(bits.white, drawn_by_apriltag(number, bits.cells)) << family.name << ':' << number;
  }
}

TEST_P(AprilTagBits, OpenCvDrawsEveryTagUpsideDown) {
  const FamilyTraits& family = traits(GetParam().family);
  for (int number = 0; number < family.id_count; number += 5) {
    const MarkerBits bits = marker_bits({family.family, number});
    const Cells backwards(bits.white.rbegin(), bits.white.rend());
    ASSERT_EQ(backwards, drawn_by_opencv(family.family, number, bits.cells)) << number;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Families, AprilTagBits,
    testing::Values(AprilTagFamily{Family::tag16h5, tag16h5_create, tag16h5_destroy},
                    AprilTagFamily{Family::tag25h9, tag25h9_create, tag25h9_destroy},
                    AprilTagFamily{Family::tag36h10, tag36h10_create, tag36h10_destroy},
                    AprilTagFamily{Family::tag36h11, tag36h11_create, tag36h11_destroy}),
    [](const auto& info) { return std::string(name_of(info.param.family)); });

TEST(MarkerBits, BorderIsBlack) {
  for (const FamilyTraits& family : all_families()) {
    const MarkerBits bits = marker_bits({family.family, 1});
    for (int i = 0; i < bits.cells; ++i) {
      EXPECT_FALSE(bits.is_white(0, i) || bits.is_white(bits.cells - 1, i));
      EXPECT_FALSE(bits.is_white(i, 0) || bits.is_white(i, bits.cells - 1));
    }
  }
}

TEST(MarkerBitsDeathTest, NumberOutsideTheFamilyIsABug) {
  EXPECT_DEATH((void)marker_bits({Family::tag16h5, 30}), "internal check failed");
  EXPECT_DEATH((void)marker_bits({Family::tag16h5, -1}), "internal check failed");
}

}  // namespace
}  // namespace waymark
