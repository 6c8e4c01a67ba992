#include "locd/pose/localizer_options.h"

namespace waymark {

Status LocalizerOptions::check() const {
  return RangeCheck()
      .part("gate", gate.check())
      .field("prior_max_age_s", prior_max_age_s, kPriorMaxAge_s)
      .field("negligible_skew in ms", in_us(negligible_skew) / 1e3, kNegligibleSkew_ms)
      .field("detection_threads", detection_threads, kDetectionThreads)
      .status();
}

SigmaCircumstances LocalizerOptions::circumstances() const {
  SigmaCircumstances circumstances;
  circumstances.triggered = triggered;
  return circumstances;
}

MotionOptions LocalizerOptions::motion() const {
  MotionOptions options;
  options.max_age_s = prior_max_age_s;
  return options;
}

ImageHealthOptions LocalizerOptions::image_health() const {
  ImageHealthOptions options;
  options.doubt_first_images = doubt_first_images;
  return options;
}

}  // namespace waymark
