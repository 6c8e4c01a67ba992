// What is no regular file where one is read: refused at once, and said what it is.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "core/camera/kalibr.h"
#include "core/geometry/tum.h"
#include "core/map/map_file.h"
#include "core/map/map_json.h"
#include "core/map/quarantine.h"
#include "core/marker/marker_catalog.h"
#include "locd/service/config.h"
#include "mapbuilder/import/calib_json.h"
#include "mapbuilder/import/survey.h"
#include "tests/fuzz/format.h"
#include "tests/support/temporary_folder.h"

namespace waymark::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;

struct FileReader {
  const char* name;
  std::function<std::optional<Error>(const fs::path&)> read;
};

template <typename Read>
FileReader file_reader(const char* name, Read read) {
  return {name, [read](const fs::path& path) -> std::optional<Error> {
            const auto result = read(path);
            if (result) return std::nullopt;
            return result.error();
          }};
}

class SpecialFiles : public testing::TestWithParam<FileReader> {
 protected:
  SpecialFiles() {
    EXPECT_EQ(::mkfifo((folder_.path() / "pipe").c_str(), 0600), 0);
    fs::create_directory(folder_.path() / "folder");
    fs::create_symlink("/dev/zero", folder_.path() / "endless");
    fs::create_symlink("/dev/null", folder_.path() / "empty");
    fs::create_symlink("loop", folder_.path() / "loop");
    fs::create_symlink("absent", folder_.path() / "dangling");
  }
  TemporaryFolder folder_;
};

TEST_P(SpecialFiles, AreRefusedAtOnce) {
  for (const char* name : {"pipe", "folder", "endless", "empty", "loop", "dangling", "absent",
                           "loop/below", "folder/absent"}) {
    const fs::path path = folder_.path() / name;
    const auto refused = GetParam().read(path);
    ASSERT_TRUE(refused) << name;
    EXPECT_EQ(refused->kind, ErrorKind::no_input) << name;
    EXPECT_THAT(refused->message,
                AllOf(StartsWith(path.string() + ": "),
                      AnyOf(HasSubstr("can't open: "), HasSubstr("can't read: it is"))));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Readers, SpecialFiles,
    testing::Values(
        file_reader("Camchain", read_camchain), file_reader("MarkerCatalog", read_marker_catalog),
        file_reader("Config", read_config), file_reader("MapFile", read_map_file),
        file_reader("MapJson", read_map_json), file_reader("Quarantine", read_quarantine),
        file_reader("Tum", read_tum), file_reader("CalibJson", read_calib_json),
        file_reader("Survey", [](const fs::path& path) { return read_survey(path, {}); })),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace waymark::test
