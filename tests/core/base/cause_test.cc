#include "core/base/cause.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace waymark {
namespace {

/// FORMATS.md's list, to the letter.
constexpr std::array kGroups{
    std::pair{"input",
              "stamps csv format family unlisted_ids mirrored inverted_print border margin "
              "dark blind_camera"},
    std::pair{"time", "clock frame_order"},
    std::pair{"rig", "rig_inverted rig_unit rig_turned rig_exchanged rig_displaced rig_bumped"},
    std::pair{"lens", "intrinsics resolution crop rectified images_turned response"},
    std::pair{"size", "size_scale size print_not_square"},
    std::pair{"markers", "wrong_id twin moved moving_group riding few_views"},
    std::pair{"map", "disconnected other_place map_misfit map_entry not_level scale_unknown"},
    std::pair{"survey", "survey_unit survey_mirrored survey_entry survey_corner"}};

TEST(Cause, TheListIsThatOfTheFormats) {
  std::map<std::string, std::string> groups;
  for (const CauseText& text : all_causes()) {
    std::string& names = groups[std::string(text.about)];
    names += (names.empty() ? "" : " ") + std::string(text.name);
  }
  ASSERT_EQ(groups.size(), kGroups.size());
  for (const auto& [about, names] : kGroups) EXPECT_EQ(groups[about], names);
}

TEST(Cause, EveryOneHasANameOfItsOwnAndTextsThatEndAsSentences) {
  std::set<std::string_view> names;
  for (const CauseText& text : all_causes()) {
    EXPECT_TRUE(names.insert(text.name).second) << text.name;
    EXPECT_EQ(cause_from_name(text.name), text.cause);
    for (const std::string_view sentence : {text.means, text.told, text.remedy}) {
      EXPECT_TRUE(sentence.ends_with('.')) << text.name << ": " << sentence;
    }
  }
  EXPECT_EQ(cause_from_name("gremlins"), std::nullopt);
}

}  // namespace
}  // namespace waymark
