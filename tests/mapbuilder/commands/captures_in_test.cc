#include "mapbuilder/commands/captures_in.h"

#include <gmock/gmock.h>

#include <sstream>

#include "core/base/one_line.h"
#include "tests/support/peak_memory.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::Not;

class CapturesIn : public testing::Test {
 protected:
  /// A capture with one detection; returns its folder.
  std::filesystem::path make_capture(const std::string& name) const {
    folder_.write(name + "/rig.yaml", tiny_rig_yaml(1));
    folder_.write(name + "/markers.toml", tiny_markers_toml());
    folder_.write(name + "/detections.csv",
                  "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3\n5,cam0,3,9,9,30,9,30,30,9,30\n"
                  "6,cam0,99,9,9,30,9,30,30,9,30\n");
    return folder_.path() / name;
  }

  /// Of a table that says of so many images that they were seen, and nothing found.
  std::filesystem::path make_blank_capture(int images) const {
    const auto capture = make_capture("blank");
    std::string text = "t_ns,camera,marker_id,x0,y0,x1,y1,x2,y2,x3,y3\n";
    for (int i = 0; i < images; ++i)
      text += fmt::format("{},cam0,,,,,,,,,\n", std::int64_t{1'000'000} * i);
    folder_.write("blank/detections.csv", text);
    return capture;
  }

  void expect_failure(ErrorKind kind, const char* message) {
    const auto captures = take_captures_in(input_, progress_, notes_);
    ASSERT_FALSE(captures) << "expected: " << message;
    EXPECT_EQ(captures.error().kind, kind);
    EXPECT_THAT(captures.error().message, HasSubstr(message));
  }

  TemporaryFolder folder_;
  CaptureInput input_;
  Progress progress_{false};
  std::ostringstream notes_;
};

TEST_F(CapturesIn, TakesEveryCaptureAndSaysWhatItFound) {
  input_.paths = {make_capture("a"), make_capture("b")};
  const auto captures = take_captures_in(input_, progress_, notes_);
  ASSERT_TRUE(captures) << captures.error().message;
  ASSERT_EQ(captures->captures.size(), 2U);
  EXPECT_EQ(captures->captures[1].images.size(), 2U);
  EXPECT_THAT(notes_.str(), HasSubstr("b: 2 images, 1 markers found (from detections.csv)\n"));
  EXPECT_THAT(notes_.str(), HasSubstr("note: "));
}

TEST_F(CapturesIn, AFoldersNameIsPrintable) {
  input_.paths = {make_capture("a\x1b]0;x\a\nb\u202e")};
  input_.survey_not_asked = true;
  folder_.write("a\x1b]0;x\a\nb\u202e/survey.toml", "");
  ASSERT_TRUE(take_captures_in(input_, progress_, notes_));
  EXPECT_THAT(notes_.str(), HasSubstr("a\\x1b]0;x\\x07\\nb\\u202e: 2 images"));
  EXPECT_THAT(notes_.str(), HasSubstr("/survey.toml: used only"));
  std::istringstream lines(notes_.str());
  for (std::string line; std::getline(lines, line);) EXPECT_EQ(in_one_line(line), line);
}

TEST_F(CapturesIn, TakesThePapersLayout) {
  const auto papers = make_capture("c");
  std::filesystem::remove(papers / "markers.toml");
  folder_.write("c/sfm.toml", "[marker]\ntype='apriltag'\nfamily='36h11'\nboard_size=0.1\n");
  input_.paths = {papers};
  const auto captures = take_captures_in(input_, progress_, notes_);
  ASSERT_TRUE(captures) << captures.error().message;
  EXPECT_EQ(captures->captures.front().images.size(), 2U);
}

TEST_F(CapturesIn, AMissingCaptureIsFoundBeforeTheFirstIsSearched) {
  input_.paths = {make_capture("a"), folder_.path() / "absent"};
  expect_failure(ErrorKind::no_input, "absent: no such capture folder");
  EXPECT_EQ(notes_.str(), "");
}

TEST_F(CapturesIn, AFileIsAVideoAndNeedsRigAndMarkers) {
  const auto file = folder_.write("walk.avi", "no video");
  input_.paths = {make_capture("a"), file};
  expect_failure(ErrorKind::usage, "walk.avi: a video or a log needs both --rig and --markers");
  input_.paths = {file};
  input_.rig_yaml = folder_.write("rig.yaml", tiny_rig_yaml(1));
  expect_failure(ErrorKind::usage, "walk.avi: a video or a log needs both --rig and --markers");
  input_.markers_toml = folder_.write("markers.toml", tiny_markers_toml());
  expect_failure(ErrorKind::bad_data, "walk.avi: not a video");
}

TEST_F(CapturesIn, ASurveyIsSpokenOfOnlyWhereItCouldBeAskedFor) {
  input_.paths = {make_capture("a")};
  folder_.write("a/survey.toml", "");
  ASSERT_TRUE(take_captures_in(input_, progress_, notes_));
  EXPECT_THAT(notes_.str(), Not(HasSubstr("--survey")));
  input_.survey_not_asked = true;
  ASSERT_TRUE(take_captures_in(input_, progress_, notes_));
  EXPECT_THAT(notes_.str(), HasSubstr("used only when asked for: --survey"));
}

TEST_F(CapturesIn, ImagesWithoutAnyMarkerAreReadInTheMemoryOfTheirRowsAndRefused) {
  input_.paths = {make_blank_capture(400'000)};
  const std::size_t bytes = std::filesystem::file_size(folder_.path() / "blank/detections.csv");
  Status seen;
  const std::size_t peak = test::peak_memory([&] {
    const auto taken = take_captures_in(input_, progress_, notes_);
    ASSERT_TRUE(taken) << taken.error().message;
    const auto observations = make_observations(taken->captures, {});
    ASSERT_TRUE(observations);
    seen = check_any_seen(*observations, "blank");
  });
  EXPECT_LT(peak, 50'000'000 + 20 * bytes);
  ASSERT_FALSE(seen);
  EXPECT_EQ(seen.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(seen.error().message, HasSubstr("blank: 400000 frame sets show no marker"));
}

}  // namespace
}  // namespace waymark
