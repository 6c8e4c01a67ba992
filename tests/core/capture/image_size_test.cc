#include "core/capture/image_size.h"

#include <gmock/gmock.h>

namespace waymark {
namespace {

using testing::HasSubstr;

TEST(ImageSizeCheck, TwoHundredMegapixelsAreTheMost) {
  EXPECT_TRUE(check_image_size({20'000, 10'000}, {}));
  EXPECT_TRUE(check_image_size({1, 1}, {}));
  for (const ImageSize size :
       {ImageSize{20'001, 10'000}, ImageSize{4'294'967'295, 4'294'967'295}}) {
    const Status status = check_image_size(size, {});
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message, HasSubstr("more than 200 megapixels"));
  }
}

TEST(ImageSizeCheck, AnExpectedSizeIsHeldToThePixel) {
  EXPECT_TRUE(check_image_size({64, 48}, ImageSize{64, 48}));
  for (const ImageSize size : {ImageSize{65, 48}, ImageSize{48, 64}, ImageSize{64, 47}}) {
    const Status status = check_image_size(size, ImageSize{64, 48});
    ASSERT_FALSE(status);
    EXPECT_THAT(status.error().message, HasSubstr("rig.yaml says 64×48"));
  }
}

}  // namespace
}  // namespace waymark
