#include "core/base/told_apart.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

using Texts = std::pair<std::string, std::string>;

TEST(ToldApart, TwoDigitsDoWhereTheyTell) {
  EXPECT_EQ(told_apart(0.35, 0.1), (Texts{"0.35", "0.1"}));
  EXPECT_EQ(told_apart(12345, 10), (Texts{"1.2e+04", "10"}));
}

TEST(ToldApart, WhatLiesCloseGetsAsManyAsItTakes) {
  EXPECT_EQ(told_apart(0.104, 0.1), (Texts{"0.104", "0.1"}));
  EXPECT_EQ(told_apart(0.10004, 0.1), (Texts{"0.10004", "0.1"}));
  for (double near = 0.1; near < 0.105; near += 0.0001) {
    const auto [a, b] = told_apart(near * 1.0001, 0.1);
    EXPECT_NE(a, b) << near;
  }
}

TEST(ToldApart, EqualOnesAreAlike) { EXPECT_EQ(told_apart(0.1, 0.1), (Texts{"0.1", "0.1"})); }

}  // namespace
}  // namespace waymark
