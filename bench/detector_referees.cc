#include "bench/detector_referees.h"

#include <opencv2/aruco.hpp>

#include "mapbuilder/referees/apriltag_family.h"
#include "mapbuilder/referees/opencv_dictionary.h"

namespace waymark::bench {
namespace {

/// OpenCV's detector as who calls it without parameters has it.
class OpencvDefault final : public MarkerDetector {
 public:
  explicit OpencvDefault(Family family)
      : family_(family),
        dictionary_(cv::aruco::getPredefinedDictionary(opencv_dictionary(family))) {}

 private:
  const std::vector<Detection>& find(const GrayView& image, std::span<const ImageWindow>) override {
    const cv::Mat pixels(image.height_px, image.width_px, CV_8UC1,
                         const_cast<std::uint8_t*>(image.data), image.stride_bytes);
    cv::aruco::detectMarkers(pixels, dictionary_, quads_, numbers_);
    found_.clear();
    const std::size_t turn = opencv_draws_upside_down(family_) ? 2 : 0;
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      Detection detection;
      detection.marker = {family_, numbers_[i]};
      for (std::size_t k = 0; k < 4; ++k) {
        const cv::Point2f& corner = quads_[i][(k + turn) % 4];
        detection.corners[k] = {corner.x, corner.y};
      }
      found_.push_back(detection);
    }
    return found_;
  }

  Family family_;
  cv::Ptr<cv::aruco::Dictionary> dictionary_;
  std::vector<std::vector<cv::Point2f>> quads_;
  std::vector<int> numbers_;
  std::vector<Detection> found_;
};

/// libapriltag with its own settings but for how far it shrinks the image.
class Apriltag final : public MarkerDetector {
 public:
  Apriltag(Family family, float decimate) : family_(family) {
    apriltag_detector_add_family_bits(detector_, tags_, traits(family).id_count > 10'000 ? 0 : 2);
    detector_->quad_decimate = decimate;
    detector_->nthreads = 1;
  }
  ~Apriltag() override {
    apriltag_detector_destroy(detector_);
    apriltag_family(family_)->destroy(tags_);
  }

 private:
  const std::vector<Detection>& find(const GrayView& image, std::span<const ImageWindow>) override {
    image_u8_t pixels{image.width_px, image.height_px, static_cast<int>(image.stride_bytes),
                      const_cast<std::uint8_t*>(image.data)};
    zarray_t* found = apriltag_detector_detect(detector_, &pixels);
    found_.clear();
    for (int i = 0; i < zarray_size(found); ++i) {
      apriltag_detection_t* tag = nullptr;
      zarray_get(found, i, static_cast<void*>(&tag));
      Detection detection;
      detection.marker = {family_, tag->id};
      detection.hamming = tag->hamming;
      for (std::size_t k = 0; k < 4; ++k) {
        detection.corners[k] = {tag->p[3 - k][0] - 0.5, tag->p[3 - k][1] - 0.5};
      }
      found_.push_back(detection);
    }
    apriltag_detections_destroy(found);
    return found_;
  }

  Family family_;
  apriltag_family_t* tags_ = apriltag_family(family_)->create();
  apriltag_detector_t* detector_ = apriltag_detector_create();
  std::vector<Detection> found_;
};

}  // namespace

std::vector<NamedDetector> all_detectors(Family family) {
  std::vector<NamedDetector> all;
  const MarkerCatalog catalog({{family, 0.1, {}, {}}});
  all.push_back({"own", make_detector({&family, 1})});
  if (is_in_opencv(family)) {
    auto ours = make_detector(DetectorEngine::opencv, catalog, "bench");
    if (ours) all.push_back({"opencv, ours", std::move(*ours)});
    all.push_back({"opencv default", std::make_unique<OpencvDefault>(family)});
  }
  if (apriltag_family(family) != nullptr) {
    all.push_back({"apriltag, half", std::make_unique<Apriltag>(family, 2)});
    all.push_back({"apriltag, full", std::make_unique<Apriltag>(family, 1)});
  }
  return all;
}

}  // namespace waymark::bench
