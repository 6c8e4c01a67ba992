#include "mapbuilder/print/pdf_file.h"

#include <gtest/gtest.h>

namespace waymark {
namespace {

TEST(PdfFile, HasAPagePerSheet) {
  Sheet sheet;
  sheet.squares.push_back({{Family::tag36h11, 3}, {20, 20, 100, 100}, {0, 0, 210, 297}});
  sheet.lines.push_back({5, 5, 10, 10});
  sheet.labels.push_back({5, 50, 3, "tag36h11 3"});
  const auto pdf = pdf_of({sheet, sheet, sheet});
  ASSERT_TRUE(pdf) << pdf.error().message;
  EXPECT_TRUE(pdf->starts_with("%PDF-"));
  EXPECT_NE(pdf->find("/Count 3"), std::string::npos);
}

TEST(PdfFile, ASheetWithNothingOnItIsAPageToo) {
  const auto pdf = pdf_of({Sheet{}});
  ASSERT_TRUE(pdf);
  EXPECT_NE(pdf->find("/Count 1"), std::string::npos);
}

TEST(PdfFile, WhatTheLibraryRefusesIsAnErrorNotACrash) {
  Sheet sheet;
  sheet.paper = {1e9, 1e9};
  sheet.labels.push_back({5, 50, 1e9, "too large"});
  const auto pdf = pdf_of({sheet, sheet});
  ASSERT_FALSE(pdf);
  EXPECT_EQ(pdf.error().kind, ErrorKind::internal);
}

}  // namespace
}  // namespace waymark
