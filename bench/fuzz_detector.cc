// Mutated images of markers, as many as asked for: odd sizes, rows that are padded, extremes, cuts,
// noise, negatives, scratches; searched as a whole and in windows, with all families and inverted
// prints. Whatever is found must be finite and lie about the image. Built with a sanitizer it finds
// what no check does.
// Usage: bench_fuzz_detector IMAGES [SEED]

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>

#include "core/base/check.h"
#include "core/detect/image_detector.h"
#include "tests/support/printed_wall.h"

namespace {

using namespace waymark;  // NOLINT(google-build-using-namespace): a program of one file

class Mutations {
 public:
  explicit Mutations(std::uint32_t seed) : random_(seed) {}

  int below(int count) { return static_cast<int>(random_() % static_cast<unsigned>(count)); }

  /// A wall with prints of any family and size.
  GrayImage wall() {
    test::Print print;
    const auto families = all_families();
    print.family =
        families[static_cast<std::size_t>(below(static_cast<int>(families.size())))].family;
    print.side_px = 10 + below(90);
    print.inverted = below(4) == 0;
    print.margin_cells = 0.25 * below(8);
    print.black = below(120);
    print.white = print.black + 10 + below(126);
    print.wall = below(256);
    for (int& number : print.numbers) number = below(traits(print.family).id_count);
    return test::wall_with(print, below(40));
  }

  /// A part of it, of any size, its rows padded by up to 40 bytes.
  GrayImage cut(const GrayImage& image, int& width) {
    width = 1 + below(below(3) == 0 ? 30 : image.width_px);
    const int height = 1 + below(below(3) == 0 ? 30 : image.height_px);
    const int x = below(image.width_px - width + 1);
    const int y = below(image.height_px - height + 1);
    GrayImage part(width + below(41), height, static_cast<std::uint8_t>(below(256)));
    for (int row = 0; row < height; ++row) {
      std::copy_n(image.row(y + row) + x, width, part.row(row));
    }
    return part;
  }

  void spoil(GrayImage& image) {
    for (int i = below(4); i > 0; --i) spoil_once(image);
  }

 private:
  void spoil_once(GrayImage& image) {
    const int kind = below(6);
    const int amount = 1 + below(120);
    if (kind == 0) return scratch(image);
    for (std::uint8_t& grey : image.pixels) {
      const int value = kind == 1   ? 255 - grey
                        : kind == 2 ? grey + below(amount) - amount / 2
                        : kind == 3 ? (grey > amount ? 255 : 0)
                        : kind == 4 ? (below(50) == 0 ? 255 * below(2) : grey)
                                    : grey / amount * amount;
      grey = static_cast<std::uint8_t>(std::clamp(value, 0, 255));
    }
  }

  /// Lines of one grey.
  void scratch(GrayImage& image) {
    const auto grey = static_cast<std::uint8_t>(below(256));
    for (int i = 1 + below(5); i > 0; --i) {
      const int y = below(image.height_px);
      std::fill_n(image.row(y), image.width_px, grey);
      const int x = below(image.width_px);
      for (int row = 0; row < image.height_px; ++row) image.row(row)[x] = grey;
    }
  }

  std::mt19937 random_;
};

MarkerCatalog catalog_of_all(bool inverted) {
  std::vector<MarkerCatalog::FamilyEntry> entries;
  for (const FamilyTraits& family : all_families()) {
    // Of families that begin with one another the largest.
    if (family.id_count < 1000 && family.family <= Family::aruco_7x7_1000) continue;
    entries.emplace_back().family = family.family;
    entries.back().default_size_m = 0.1;
    entries.back().inverted = inverted;
  }
  return MarkerCatalog(entries);
}

void check(const FoundMarkers& found, const GrayView& image) {
  WAYMARK_CHECK(found.failure.empty());
  const double reach = 20 + std::max(image.width_px, image.height_px);
  for (const Detection& one : found.detections) {
    for (const Eigen::Vector2d& corner : one.corners) {
      WAYMARK_CHECK(corner.allFinite() && corner.cwiseAbs().maxCoeff() < 2 * reach);
    }
    for (const Eigen::Matrix2d& covariance : *one.covariances) {
      WAYMARK_CHECK(covariance.allFinite() && covariance.determinant() > 0);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 64;
  const long images = std::strtol(argv[1], nullptr, 10);
  Mutations mutations(argc > 2 ? static_cast<std::uint32_t>(std::strtoul(argv[2], nullptr, 10))
                               : 1);
  ImageDetector as_drawn(catalog_of_all(false));
  ImageDetector inverted(catalog_of_all(true));
  long found = 0;
  GrayImage wall;
  for (long i = 0; i < images; ++i) {
    if (i % 20 == 0) wall = mutations.wall();
    int width = 0;
    GrayImage image = mutations.cut(wall, width);
    mutations.spoil(image);
    GrayView view = image.view();
    view.width_px = width;
    const auto camera = CameraModel::create(
        {width, image.height_px, 600, 600, 0.5 * (width - 1), 0.5 * (image.height_px - 1)});
    ImageDetector& detector = i % 3 == 0 ? inverted : as_drawn;
    std::vector<ImageWindow> windows;
    if (i % 2 == 1) {
      for (int k = 0; k < 3; ++k) {
        windows.push_back({mutations.below(600) - 80, mutations.below(500) - 80,
                           mutations.below(200), mutations.below(200)});
      }
    }
    const FoundMarkers& markers = detector.detect(view, *camera, windows);
    check(markers, view);
    found += static_cast<long>(markers.detections.size());
  }
  fmt::print("{} images, {} markers found, nothing wrong\n", images, found);
}
