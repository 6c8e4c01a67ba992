#include "locd/pose/localizer_options.h"

#include <gmock/gmock.h>

#include <cmath>
#include <string>

namespace waymark {
namespace {

using testing::HasSubstr;

TEST(LocalizerOptions, TellWhichFieldLiesOutsideItsRange) {
  EXPECT_TRUE(LocalizerOptions{}.check());
  const auto said = [](const auto& change) {
    LocalizerOptions options;
    change(options);
    const Status checked = options.check();
    return checked ? std::string() : checked.error().message;
  };
  EXPECT_THAT(said([](auto& o) { o.prior_max_age_s = std::nan(""); }),
              HasSubstr("prior_max_age_s"));
  EXPECT_THAT(said([](auto& o) { o.gate.w_max_radps = 0.001; }), HasSubstr("w_max_radps"));
  EXPECT_THAT(said([](auto& o) { o.gate.max_3sigma_m = -1; }), HasSubstr("max_3sigma_m"));
  EXPECT_THAT(said([](auto& o) { o.gate.max_3sigma_rad = 0.2; }), HasSubstr("max_3sigma_rad"));
  EXPECT_THAT(said([](auto& o) { o.detection_threads = -1; }), HasSubstr("detection_threads"));
}

TEST(LocalizerOptions, ReachThePartsThatTheyAreMeantFor) {
  LocalizerOptions options;
  options.prior_max_age_s = 0.75;
  options.doubt_first_images = true;
  EXPECT_EQ(options.motion().max_age_s, 0.75);
  EXPECT_TRUE(options.motion().check());
  EXPECT_TRUE(options.image_health().doubt_first_images);
}

}  // namespace
}  // namespace waymark
