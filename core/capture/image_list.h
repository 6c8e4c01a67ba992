#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/camera/rig.h"
#include "core/geometry/stamp.h"

namespace waymark {

/// An image file of a capture.
struct ImageFile {
  int camera = 0;  ///< index in the rig
  Stamp stamp{0};
  std::filesystem::path path;
};

/// Where a camera's images lie.
struct CameraFolder {
  int camera = 0;  ///< index in the rig
  std::filesystem::path path;
};

/// The images of a capture, none decoded yet.
struct ImageList {
  std::vector<ImageFile> images;   ///< by rising (stamp, camera)
  bool stamps_from_names = true;   ///< false: names are no stamps; sorted, 1 s apart
  std::vector<std::string> notes;  ///< what the user should know, one line each
};

/// The camK folders in `parent`, by rising camera; none when there is none at all. bad_data when
/// they and the rig's cameras are not the same; permission and io when `parent` can't be listed.
[[nodiscard]] Expected<std::vector<CameraFolder>> find_camera_folders(
    const std::filesystem::path& parent, const Rig& rig);

/// Lists the images of a capture's cameras; their names are stamps in ns, or, of a single camera,
/// any names. Numbers that can't be stamps (doubt_of_stamps), frame numbers above all, are names
/// like any other. Hidden files are passed over, other files noted. bad_data for a name that is no
/// stamp among several cameras or other stamps, for two images of one camera with one stamp, and
/// for a folder full of images in a format that is not read; permission and io when a folder can't
/// be listed. `monotonic` as for doubt_of_stamps.
[[nodiscard]] Expected<ImageList> list_images(const std::vector<CameraFolder>& folders,
                                              bool monotonic = false);

/// Entries of a folder by rising name, without hidden ones. Errors: permission, io.
[[nodiscard]] Expected<std::vector<std::filesystem::path>> list_folder(
    const std::filesystem::path& folder);

}  // namespace waymark
