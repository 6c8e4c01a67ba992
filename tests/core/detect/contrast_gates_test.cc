#include "core/detect/contrast_gates.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(ContrastGates, LieAboveWhatAQuarterOfThePlacesShow) {
  ContrastGates gates;
  for (int i = 0; i < 30; ++i) gates.add(100, 120);
  for (int i = 0; i < 60; ++i) gates.add(50, 200);
  gates.settle();
  EXPECT_EQ(gates.gate_grey(), 32);  // 1.6 · 20
  EXPECT_EQ(gates.at(120), 32);
}

TEST(ContrastGates, AreLowerWhereAnImageIsDark) {
  ContrastGates gates;
  for (int i = 0; i < 60; ++i) gates.add(5, 15);
  for (int i = 0; i < 600; ++i) gates.add(170, 200);
  gates.settle();
  EXPECT_EQ(gates.gate_grey(), 48);
  EXPECT_EQ(gates.at(15), 20) << "never below";
  EXPECT_EQ(gates.at(200), 48);
}

TEST(ContrastGates, BeginAnewWithEveryImage) {
  ContrastGates gates;
  for (int i = 0; i < 100; ++i) gates.add(0, 255);
  gates.settle();
  EXPECT_EQ(gates.gate_grey(), 70) << "never above";
  for (int i = 0; i < 100; ++i) gates.add(100, 104);
  gates.settle();
  EXPECT_EQ(gates.gate_grey(), 20);
}

}  // namespace
}  // namespace waymark
