#include "drivers/mid_exposure.h"

namespace waymark {

const char* name_of(StampMeaning meaning) {
  switch (meaning) {
    case StampMeaning::start_of_exposure:
      return "start of exposure";
    case StampMeaning::end_of_frame:
      return "end of frame";
    case StampMeaning::unknown:
      break;
  }
  return "unknown";
}

MidExposure mid_exposure(StampMeaning meaning, Stamp stamp, const ExposureTiming& timing) {
  if (meaning == StampMeaning::unknown || timing.exposure == Stamp{0}) {
    return {stamp, StampQuality::approximate};
  }
  const Stamp half = (timing.exposure + timing.readout) / 2;
  const bool starts = meaning == StampMeaning::start_of_exposure;
  return {starts ? stamp + half : stamp - half, StampQuality::exact};
}

}  // namespace waymark
