#include "mapbuilder/print/pdf_file.h"

#include <hpdf.h>

#include <algorithm>
#include <memory>

#include "core/marker/marker_bits.h"

namespace waymark {
namespace {

constexpr double kPointsPerMm = 72 / 25.4;
constexpr double kHairline_mm = 0.1;

HPDF_REAL points(double mm) { return static_cast<HPDF_REAL>(kPointsPerMm * mm); }

/// The part of a box that lies in a window; nothing is left where width or height is not positive.
Box clipped(const Box& box, const Box& window) {
  Box part;
  part.left_mm = std::max(box.left_mm, window.left_mm);
  part.top_mm = std::max(box.top_mm, window.top_mm);
  part.width_mm = std::min(box.right_mm(), window.right_mm()) - part.left_mm;
  part.height_mm = std::min(box.bottom_mm(), window.bottom_mm()) - part.top_mm;
  return part;
}

/// Runs of black cells in a marker's rows.
std::vector<Box> black_runs(const PrintedSquare& printed) {
  const MarkerBits bits = marker_bits(printed.id);
  const double cell = printed.square.width_mm / bits.cells;
  const int end = bits.cells + bits.outside;
  const auto is_black = [&](int row, int column) {
    return !bits.is_white(row, column) && bits.kind(row, column) != CellKind::nothing;
  };
  std::vector<Box> runs;
  for (int row = -bits.outside; row < end; ++row) {
    for (int column = -bits.outside; column < end; ++column) {
      if (!is_black(row, column)) continue;
      const int first = column;
      while (column + 1 < end && is_black(row, column + 1)) ++column;
      runs.push_back({printed.square.left_mm + first * cell, printed.square.top_mm + row * cell,
                      (column + 1 - first) * cell, cell});
    }
  }
  return runs;
}

/// Draws sheets by the library, whose unit is 1/72 inch from the lower left corner.
class PdfWriter {
 public:
  PdfWriter() : document_(HPDF_New(keep_error, this), HPDF_Free) {
    if (!document_) return;
    HPDF_SetCompressionMode(document_.get(), HPDF_COMP_ALL);
    font_ = HPDF_GetFont(document_.get(), "Helvetica", "WinAnsiEncoding");
  }

  void add(const Sheet& sheet) {
    // After an error the library gives no page; take() tells it.
    page_ = document_ && error_ == HPDF_OK ? HPDF_AddPage(document_.get()) : nullptr;
    if (page_ == nullptr) return;
    height_mm_ = sheet.paper.height_mm;
    HPDF_Page_SetWidth(page_, points(sheet.paper.width_mm));
    HPDF_Page_SetHeight(page_, points(sheet.paper.height_mm));
    for (const PrintedSquare& square : sheet.squares) draw(square);
    HPDF_Page_SetLineWidth(page_, points(kHairline_mm));
    for (const Line& line : sheet.lines) {
      HPDF_Page_MoveTo(page_, points(line.x0_mm), points(height_mm_ - line.y0_mm));
      HPDF_Page_LineTo(page_, points(line.x1_mm), points(height_mm_ - line.y1_mm));
    }
    if (!sheet.lines.empty()) HPDF_Page_Stroke(page_);
    for (const Label& label : sheet.labels) draw(label);
  }

  /// The whole file.
  Expected<std::string> take() {
    if (document_ && error_ == HPDF_OK) HPDF_SaveToStream(document_.get());
    if (!document_ || error_ != HPDF_OK) {
      return fail(ErrorKind::internal, "the PDF can't be made: libharu's error 0x{:04x}", error_);
    }
    std::string text(HPDF_GetStreamSize(document_.get()), '\0');
    auto size = static_cast<HPDF_UINT32>(text.size());
    HPDF_ReadFromStream(document_.get(), reinterpret_cast<HPDF_BYTE*>(text.data()), &size);
    text.resize(size);
    return text;
  }

 private:
  static void keep_error(HPDF_STATUS error, HPDF_STATUS /*detail*/, void* writer) {
    static_cast<PdfWriter*>(writer)->error_ = error;
  }

  /// Fills boxes as one path, so that no seams show between them.
  void fill(const std::vector<Box>& boxes, double grey) {
    HPDF_Page_SetGrayFill(page_, static_cast<HPDF_REAL>(grey));
    bool any = false;
    for (const Box& box : boxes) {
      if (!(box.width_mm > 0 && box.height_mm > 0)) continue;
      HPDF_Page_Rectangle(page_, points(box.left_mm), points(height_mm_ - box.bottom_mm()),
                          points(box.width_mm), points(box.height_mm));
      any = true;
    }
    if (any) HPDF_Page_Fill(page_);
  }

  void draw(const PrintedSquare& printed) {
    std::vector<Box> black = black_runs(printed);
    for (Box& run : black) run = clipped(run, printed.window);
    fill(black, 0);
  }

  void draw(const Label& label) {
    HPDF_Page_SetGrayFill(page_, 0);
    HPDF_Page_BeginText(page_);
    HPDF_Page_SetFontAndSize(page_, font_, points(label.height_mm));
    HPDF_Page_TextOut(page_, points(label.left_mm), points(height_mm_ - label.baseline_mm),
                      label.text.c_str());
    HPDF_Page_EndText(page_);
  }

  HPDF_STATUS error_ = HPDF_OK;
  std::unique_ptr<_HPDF_Doc_Rec, void (*)(HPDF_Doc)> document_;
  HPDF_Font font_ = nullptr;
  HPDF_Page page_ = nullptr;
  double height_mm_ = 0;
};

}  // namespace

Expected<std::string> pdf_of(const std::vector<Sheet>& sheets) {
  PdfWriter writer;
  for (const Sheet& sheet : sheets) writer.add(sheet);
  return writer.take();
}

}  // namespace waymark
