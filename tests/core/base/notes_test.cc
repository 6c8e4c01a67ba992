#include "core/base/notes.h"

#include <gmock/gmock.h>

namespace waymark {
namespace {

using testing::ElementsAre;

TEST(ShownNotes, AreTheFirstTwentyAndHowManyMoreThereAre) {
  std::vector<std::string> notes(20, "unknown key");
  EXPECT_EQ(shown_notes(notes), notes);
  notes.resize(60'002, "unknown key");
  const auto lines = shown_notes(notes);
  ASSERT_EQ(lines.size(), 21U);
  EXPECT_EQ(lines.back(), "… and 59982 more like these");
  EXPECT_TRUE(shown_notes({}).empty());
}

TEST(ShownNotes, ArePrintableLines) {
  EXPECT_THAT(shown_notes({"key 'a\n<0>b'"}), ElementsAre("key 'a\\n<0>b'"));
  EXPECT_LE(shown_notes({std::string(100'000, 'x')}).front().size(), 500U);
}

TEST(ShownNotes, SayTheirCauseWhereTheyHaveOne) {
  EXPECT_EQ(note_line("no images"), "note: no images");
  EXPECT_EQ(note_line(caused_note(Cause::format, "rig.yaml: x")), "note [format] rig.yaml: x");
  EXPECT_EQ(note_line("[a] folder's name"), "note: [a] folder's name");
}

}  // namespace
}  // namespace waymark
