#include "locd/service/camera_sources.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

using testing::HasSubstr;

Error error_of(const std::string& camera) {
  const TemporaryFolder tmp;
  tmp.write("rig.yaml", tiny_rig_yaml(1));
  const auto file = tmp.write(
      "locd.toml", "[rig]\ncamchain = \"rig.yaml\"\n[[camera]]\nname = \"cam0\"\n" + camera + "\n");
  const auto setup = load_setup(file);
  if (!setup) return setup.error();
  const auto sources = make_sources(*setup);
  return sources ? Error{ErrorKind::internal, (*sources)[0]->name()} : sources.error();
}

TEST(MakeSources, OpensNoDevice) {
  const Error made = error_of("driver = \"v4l2\"\ndevice = \"serial=4711\"\nformat = \"MJPEG\"");
  EXPECT_EQ(made.kind, ErrorKind::internal) << made.message;
  EXPECT_EQ(made.message, "cam0");
}

TEST(MakeSources, NumbersAndUnknownFormatsAreRefused) {
  const Error number = error_of("driver = \"v4l2\"\ndevice = \"/dev/video0\"");
  EXPECT_EQ(number.kind, ErrorKind::config);
  EXPECT_THAT(number.message, HasSubstr("[[camera]] cam0: device \"/dev/video0\" is a number"));
  const Error format = error_of("driver = \"v4l2\"\ndevice = \"serial=1\"\nformat = \"RGB3\"");
  EXPECT_EQ(format.kind, ErrorKind::config);
  EXPECT_THAT(format.message, HasSubstr("\"RGB3\" is none of GREY, NV12"));
}

}  // namespace
}  // namespace waymark
