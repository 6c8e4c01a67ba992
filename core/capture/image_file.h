#pragma once

#include <filesystem>
#include <optional>

#include "core/base/error.h"
#include "core/capture/gray_image.h"
#include "core/capture/image_size.h"

namespace waymark {

/// Whether the name's ending is one that read_gray_image reads (jpg, jpeg, png, pgm; any case).
[[nodiscard]] bool is_image_name(const std::filesystem::path& path);

/// Reads JPEG (libjpeg-turbo; colour by its luma), PNG (spng; colour by Rec. 601 luma, alpha
/// dropped), PGM P5 (8 or 16 bit), whichever the content is. The header comes first: an image that
/// is not of the `expected` size is refused before a pixel is decoded, and a file that is larger
/// than such an image can be before it is read. bad_data for those, and for truncated, damaged,
/// empty, sparse or non-image files and more than 200 megapixels; no_input when absent.
[[nodiscard]] Expected<LoadedImage> read_gray_image(const std::filesystem::path& path,
                                                    std::optional<ImageSize> expected = {});

/// The size that the image's header states; the errors of read_gray_image.
[[nodiscard]] Expected<ImageSize> read_image_size(const std::filesystem::path& path);

/// Writes atomically; the ending (jpg, jpeg, png, pgm) chooses the format. JPEG quality 1…100.
/// usage for another ending; otherwise the errors of write_file_atomically.
[[nodiscard]] Status write_gray_image(const std::filesystem::path& path, const GrayView& image,
                                      int jpeg_quality = 95);

}  // namespace waymark
