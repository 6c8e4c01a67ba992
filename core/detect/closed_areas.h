#pragma once

#include "core/capture/gray_image.h"

namespace waymark {

/// The grey level that divides an image's pixels best into darker and brighter ones (Otsu, "A
/// threshold selection method from gray-level histograms", 1979): brighter is what lies above.
[[nodiscard]] int dividing_grey(const GrayView& image);

/// Fills gaps of up to 2 · radius_px between white (255) areas of an image of black and white: each
/// area grows by a square of that radius, then shrinks by it. Outside of the image is neither.
[[nodiscard]] GrayImage closed(const GrayImage& image, int radius_px);

}  // namespace waymark
