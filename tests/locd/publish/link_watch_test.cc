#include "locd/publish/link_watch.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(LinkWatch, IsRaisedOnceAndOverOnceWithWhatWasLost) {
  LinkWatch link;
  EXPECT_FALSE(link.look(0));
  const auto raised = link.look(3);
  ASSERT_TRUE(raised);
  EXPECT_TRUE(raised->raised);
  EXPECT_TRUE(link.down());
  EXPECT_FALSE(link.look(10)) << "it is known";
  const auto over = link.look(10);
  ASSERT_TRUE(over);
  EXPECT_FALSE(over->raised);
  EXPECT_EQ(over->lost, 10);
  EXPECT_FALSE(link.down());
}

TEST(LinkWatch, CountsEachTimeAnew) {
  LinkWatch link;
  (void)link.look(5);
  (void)link.look(5);
  (void)link.look(7);
  const auto over = link.look(7);
  ASSERT_TRUE(over);
  EXPECT_EQ(over->lost, 2);
}

}  // namespace
}  // namespace waymark
