#include "mapbuilder/import/open_capture.h"

#include "mapbuilder/import/paper_layout.h"

namespace waymark {

Expected<CaptureFolder> open_capture(const std::filesystem::path& path, RigFile rig_file) {
  return is_paper_layout(path) ? open_paper_layout(path, rig_file)
                               : open_capture_folder(path, rig_file);
}

}  // namespace waymark
