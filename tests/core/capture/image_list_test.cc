#include "core/capture/image_list.h"

#include <gmock/gmock.h>

#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> names(const ImageList& list) {
  std::vector<std::string> names;
  for (const ImageFile& image : list.images) names.push_back(image.path.filename().string());
  return names;
}

TEST(ImageList, NumbersSortAsNumbersOverAllCameras) {
  const TemporaryFolder folder;
  folder.write("left/10.png", "");
  folder.write("left/9.jpg", "");
  folder.write("right/9.png", "");
  const auto list = list_images({{1, folder.path() / "right"}, {0, folder.path() / "left"}});
  ASSERT_TRUE(list) << list.error().message;
  EXPECT_THAT(names(*list), ElementsAre("9.jpg", "9.png", "10.png"));
  EXPECT_EQ(list->images[1].camera, 1);
  EXPECT_TRUE(list->stamps_from_names);
  EXPECT_THAT(list->notes, IsEmpty());
}

/// One folder per camera, empty files of the names given.
class NamedImages : public testing::Test {
 protected:
  [[nodiscard]] Expected<ImageList> list(const std::vector<std::vector<std::string>>& cameras,
                                         bool monotonic = false) const {
    std::vector<CameraFolder> folders;
    for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
      const auto path = folder_.path() / fmt::format("cam{}", camera);
      std::filesystem::remove_all(path);
      for (const std::string& name : cameras[camera]) folder_.write(path / name, "");
      folders.push_back({static_cast<int>(camera), path});
    }
    return list_images(folders, monotonic);
  }

  TemporaryFolder folder_;
};

TEST_F(NamedImages, FrameNumbersOfSeveralCamerasAreRefused) {
  const std::vector<std::vector<std::string>> variants[] = {
      {{"000001.jpg", "000002.jpg", "000003.jpg"}, {"000001.jpg", "000003.jpg"}},
      {{"0.png", "1.png", "2.png"}, {"0.png", "1.png", "2.png"}},
      {{"10.png", "20.png", "30.png"}, {"10.png", "30.png"}},
      {{"1001.png", "1002.png"}, {"1001.png", "1002.png"}},
  };
  for (const auto& names : variants) {
    const auto refused = list(names);
    ASSERT_FALSE(refused) << names[0][0];
    EXPECT_EQ(refused.error().cause, Cause::stamps);
    EXPECT_THAT(refused.error().message, HasSubstr("frame numbers"));
    EXPECT_THAT(refused.error().message, HasSubstr("cam0: "));
  }
}

TEST_F(NamedImages, OtherUnitsAreRecognized) {
  const auto refused = [&](const char* a, const char* b, const char* c) {
    const auto listed = list({{a, b, c}, {a, c}});
    EXPECT_FALSE(listed) << a;
    return listed ? std::string() : listed.error().message;
  };
  EXPECT_THAT(refused("1700000000.jpg", "1700000001.jpg", "1700000002.jpg"),
              HasSubstr("look like s (1700000001, 1 apart)"));
  EXPECT_THAT(refused("1700000000000.jpg", "1700000000033.jpg", "1700000000067.jpg"),
              HasSubstr("look like ms"));
  EXPECT_THAT(refused("1700000000000000.jpg", "1700000000033333.jpg", "1700000000066667.jpg"),
              HasSubstr("look like µs"));
  // One image every 5 s: 5 ms, were it ns.
  EXPECT_THAT(refused("1700000000000000.jpg", "1700000005000000.jpg", "1700000010000000.jpg"),
              HasSubstr("clock = \"monotonic\""));
}

TEST_F(NamedImages, StampsOfAnyEpochAndRateAreTaken) {
  const std::vector<std::string> variants[] = {
      {"1700000000000000000.jpg", "1700000000001000000.jpg", "1700000000002000000.jpg"},  // 1 kHz
      {"0.jpg", "33333333.jpg", "66666667.jpg"},
      {"-33333333.jpg", "0.jpg", "33333333.jpg"},
      {"1700000000000.jpg", "1700033333333.jpg", "1700066666667.jpg"},  // up for half an hour
      {"1700000000000000.jpg", "1700000033333333.jpg", "1700000066666667.jpg"},  // for 20 days
      {"5.jpg"},
  };
  for (const auto& names : variants) {
    const auto listed = list({names, names});
    ASSERT_TRUE(listed) << names[0] << ": " << listed.error().message;
    EXPECT_TRUE(listed->stamps_from_names);
  }
  EXPECT_TRUE(list({variants[0], {"1700000000000000.jpg", "1700000000005000.jpg"}}, true));
}

TEST_F(NamedImages, FrameNumbersOfOneCameraAreTakenInTheirOrder) {
  const auto listed = list({{"10.jpg", "9.jpg", "8.jpg"}});
  ASSERT_TRUE(listed) << listed.error().message;
  EXPECT_FALSE(listed->stamps_from_names);
  EXPECT_THAT(names(*listed), ElementsAre("8.jpg", "9.jpg", "10.jpg"));
  EXPECT_EQ(listed->images[2].stamp, std::chrono::seconds(2));
  EXPECT_THAT(listed->notes, ElementsAre(HasSubstr("look like frame numbers")));
}

TEST_F(NamedImages, NumbersBeyondAllTimeAreNames) {
  for (const char* name : {"9223372036854775807.jpg", "-9223372036854775808.jpg",
                           "4611686018427387904.jpg", "99999999999999999999.jpg"}) {
    EXPECT_FALSE(list({{name}})->stamps_from_names) << name;
    EXPECT_FALSE(list({{name}, {name}})) << name;
  }
  EXPECT_TRUE(list({{"4611686018427387903.jpg"}})->stamps_from_names);
}

TEST_F(NamedImages, AFolderOfImagesThatAreNotReadSaysHowToConvertThem) {
  for (const auto& [name, format] : {std::pair("1.bmp", "BMP"), std::pair("1.TIF", "TIFF"),
                                     std::pair("1.webp", "WebP"), std::pair("1.heic", "HEIF")}) {
    const auto refused = list({{name, "notes.txt"}});
    ASSERT_FALSE(refused) << name;
    EXPECT_EQ(refused.error().cause, Cause::format);
    EXPECT_THAT(refused.error().message, HasSubstr(fmt::format("cam0: images in {}", format)));
    EXPECT_THAT(refused.error().message, HasSubstr("mogrify -format png"));
  }
}

TEST(ImageList, NoFoldersNoImages) {
  const auto list = list_images({});
  ASSERT_TRUE(list);
  EXPECT_THAT(list->images, IsEmpty());
}

TEST(ImageList, AbsentFolderIsAnError) {
  const TemporaryFolder folder;
  const auto list = list_images({{0, folder.path() / "absent"}});
  ASSERT_FALSE(list);
  EXPECT_EQ(list.error().kind, ErrorKind::io);
  EXPECT_THAT(list.error().message, HasSubstr("absent: can't list the folder"));
}

TEST(ImageList, FolderEntriesByRisingNameWithoutHiddenOnes) {
  const TemporaryFolder folder;
  folder.write("b", "");
  folder.write(".a", "");
  folder.write("a/c", "");
  const auto entries = list_folder(folder.path());
  ASSERT_TRUE(entries);
  EXPECT_THAT(*entries, ElementsAre(folder.path() / "a", folder.path() / "b"));
}

}  // namespace
}  // namespace waymark
