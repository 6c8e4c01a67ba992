#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/capture/capture_folder.h"
#include "core/detect/square_reader.h"
#include "mapbuilder/observations/detected_capture.h"

namespace waymark {

/// How a code that nobody looks for shows in images.
struct OtherForm {
  SquareForm form;
  bool inverted = false;    ///< white where the family is black
  bool no_outline = false;  ///< the code alone: its border runs into what is around it

  auto operator<=>(const OtherForm&) const = default;
};

/// What reads so, over a sample of images.
struct FormCount {
  int squares = 0;          ///< that read so
  int exact = 0;            ///< of these, without a wrong bit
  int could = 0;            ///< that could: rim and cells are such
  double border_cells = 0;  ///< sum of the measured widths
  std::set<int> numbers;
  std::set<int> exact_numbers;
};

/// What a sample of one camera's images shows on a closer look.
struct CameraLook {
  std::string camera;
  std::size_t images = 0;  ///< looked at
  double mean_grey = 0;    ///< over them, 0 … 255
  int squares = 0;         ///< dark squares, read or not
  int stated = 0;          ///< that show a marker of markers.toml, as it ought to be
  int stated_cut = 0;      ///< that show one whose border is not one cell wide
  double cut_cells = 0;    ///< sum of their border's measured widths
  int upside_down = 0;     ///< of `stated`: the marker's top points down in the image
  std::set<int> stated_numbers;
  std::map<MarkerId, int> unlisted;  ///< of a stated family; markers.toml lacks the id
  std::map<OtherForm, FormCount> others;
};

/// Looks again at a sample of each camera's images, more closely where the detector found little:
/// at all their dark squares, read as codes of all families, mirrored, inverted and with other
/// borders. A camera without images, or that was read from a detections.csv and found something, is
/// looked at in none.
[[nodiscard]] std::vector<CameraLook> look_at_images(const CaptureFolder& folder,
                                                     const DetectedCapture& detected, int threads,
                                                     Progress& progress);

}  // namespace waymark
