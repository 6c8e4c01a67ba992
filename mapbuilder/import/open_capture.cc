#include "mapbuilder/import/open_capture.h"

#include "mapbuilder/import/paper_layout.h"

namespace waymark {

Expected<CaptureFolder> open_capture(const std::filesystem::path& path) {
  return is_paper_layout(path) ? open_paper_layout(path) : open_capture_folder(path);
}

}  // namespace waymark
