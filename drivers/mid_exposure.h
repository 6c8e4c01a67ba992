#pragma once

#include <cstdint>

#include "drivers/frame.h"

namespace waymark {

/// What a driver's time stamp tells of a frame.
enum class StampMeaning : std::uint8_t {
  start_of_exposure,  ///< of the first row
  end_of_frame,       ///< the last row has been received
  unknown,            ///< the driver does not say, or by which clock
};
[[nodiscard]] const char* name_of(StampMeaning meaning);

/// What has to be known besides, to tell the middle of an exposure.
struct ExposureTiming {
  Stamp exposure{0};  ///< length; 0: not known
  Stamp readout{0};   ///< rolling shutter, first to last row; 0 of a global one
};

/// A frame's stamp, middle of the exposure of the middle row, with how far it can be believed.
/// Unknown meanings and lengths of exposure leave the stamp as it is and make it approximate.
struct MidExposure {
  Stamp stamp{0};
  StampQuality quality = StampQuality::exact;
};
[[nodiscard]] MidExposure mid_exposure(StampMeaning meaning, Stamp stamp,
                                       const ExposureTiming& timing);

}  // namespace waymark
