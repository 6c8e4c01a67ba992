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
