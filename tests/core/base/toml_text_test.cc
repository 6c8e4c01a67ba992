#include "core/base/toml_text.h"

#include <gmock/gmock.h>

#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

using testing::HasSubstr;

TEST(TomlText, ParsesWithByteOrderMarkAndCrlf) {
  const auto table = parse_toml("\xEF\xBB\xBFsize = 3\r\nname = \"a\"\r\n", "x.toml");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ((*table)["size"].value<int>(), 3);
  EXPECT_EQ((*table)["name"].value<std::string>(), "a");
}

TEST(TomlText, SyntaxErrorNamesFileAndLine) {
  const auto table = parse_toml("a = 1\nb = = 2\n", "x.toml");
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(table.error().message, HasSubstr("x.toml: line 2: not valid TOML"));
  EXPECT_EQ(table.error().message.find('\n'), std::string::npos);
  EXPECT_EQ(parse_toml("a = ", "locd.toml", ErrorKind::config).error().kind, ErrorKind::config);
}

TEST(TomlText, BinaryAndDeeplyNestedInputFailCleanly) {
  EXPECT_FALSE(parse_toml(std::string_view("\0\x01\xFF", 3), "x.toml"));
  EXPECT_FALSE(parse_toml("a = " + std::string(100'000, '['), "x.toml"));
}

TEST(TomlText, AbsentFileIsNoInput) {
  const TemporaryFolder folder;
  const auto table = read_toml(folder.path() / "absent.toml");
  ASSERT_FALSE(table);
  EXPECT_EQ(table.error().kind, ErrorKind::no_input);
  EXPECT_THAT(table.error().message, HasSubstr("absent.toml"));
}

TEST(TomlText, UnknownKeyIsNamedWithItsLine) {
  const auto table = parse_toml("size = 3\nsizee = 4\n", "x.toml");
  ASSERT_TRUE(table);
  EXPECT_TRUE(check_toml_keys(*table, {"size", "sizee"}, "x.toml"));
  const auto status = check_toml_keys(*table, {"size", "name"}, "x.toml");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message,
            "x.toml: line 2: unknown key \"sizee\"; known here: size, name");
}

}  // namespace
}  // namespace waymark
