#include "mapbuilder/import/paper_layout.h"

#include <algorithm>
#include <iterator>
#include <string>
#include <tuple>

#include "core/base/is_there.h"
#include "core/base/text_field.h"
#include "core/base/toml_text.h"
#include "core/camera/image_sizes.h"
#include "core/camera/kalibr.h"
#include "core/capture/image_file.h"
#include "core/capture/rig_of_frames.h"
#include "mapbuilder/import/calib_json.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// The paper writes type = 'aruco', family = '4x4_1000'; our names are taken as well.
std::optional<Family> paper_family(const std::string& type, const std::string& family) {
  for (const std::string& name : {family, "aruco_" + family, "tag" + family, type}) {
    const auto known = family_from_name(name);
    if (known && name.starts_with(type.starts_with("aruco") ? "aruco" : "tag")) return known;
  }
  return std::nullopt;
}

/// Turns sfm.toml's [marker] table into the text of a markers.toml, whose reader checks the rest.
class SfmToml {
 public:
  SfmToml(const toml::table& root, std::string name) : root_(root), name_(std::move(name)) {}

  Expected<MarkerCatalog> read() const {
    const toml::table* const marker = root_["marker"].as_table();
    if (marker == nullptr) {
      return fail(ErrorKind::bad_data, "{}: no [marker] table; it states family and board_size",
                  name_);
    }
    const std::string type = lower_case((*marker)["type"].value_or(std::string("aruco")));
    const std::string family = lower_case((*marker)["family"].value_or(std::string()));
    const auto known = paper_family(type, family);
    if (!known) {
      return fail(ErrorKind::bad_data,
                  "{}: unknown markers: type \"{}\", family \"{}\"; write for instance type = "
                  "\"aruco\", family = \"4x4_1000\"",
                  toml_place(name_, *marker), type, family);
    }
    const auto sizes = sizes_text(*marker);
    if (!sizes) return tl::make_unexpected(sizes.error());
    return parse_marker_catalog(
        fmt::format("[markers]\nfamily = \"{}\"\n{}", name_of(*known), *sizes),
        name_ + " (as a markers.toml)");
  }

 private:
  /// size_m and [[markers.sizes]] from board_size = [[sizes…], [[ids…], …]], or from one number.
  Expected<std::string> sizes_text(const toml::table& marker) const {
    const toml::node* const board_size = marker.get("board_size");
    if (board_size == nullptr) {
      return fail(ErrorKind::bad_data, "{}: no board_size; it states the markers' sizes in m",
                  toml_place(name_, marker));
    }
    if (board_size->is_number()) {
      return fmt::format("size_m = {}\n", *board_size->value<double>());
    }
    const toml::array* const halves = board_size->as_array();
    const toml::array* const sizes = halves != nullptr ? halves->get_as<toml::array>(0) : nullptr;
    const toml::array* const groups = halves != nullptr ? halves->get_as<toml::array>(1) : nullptr;
    if (sizes == nullptr || groups == nullptr || halves->size() != 2 ||
        sizes->size() != groups->size()) {
      return fail(ErrorKind::bad_data,
                  "{}: board_size must be [[sizes…], [[\"default\"], [\"100-199\"], …]], as many "
                  "groups as sizes",
                  toml_place(name_, *board_size));
    }
    std::string default_size;
    std::string listed_sizes;
    for (std::size_t i = 0; i < sizes->size(); ++i) {
      const auto size_m = (*sizes)[i].value<double>();
      if (!size_m || !(*groups)[i].is_array()) {
        return fail(ErrorKind::bad_data, "{}: each size must be a number, each group a list of ids",
                    toml_place(name_, (*sizes)[i]));
      }
      std::string ids;
      for (const toml::node& item : *(*groups)[i].as_array()) {
        const std::string text = item.is_integer() ? fmt::format("{}", *item.value<std::int64_t>())
                                                   : item.value_or(std::string("?"));
        if (text != "default") {
          ids += (ids.empty() ? "" : ", ") + text;
        } else if (default_size.empty()) {
          default_size = fmt::format("size_m = {}\n", *size_m);
        } else {
          return fail(ErrorKind::bad_data, "{}: two sizes are the default",
                      toml_place(name_, item));
        }
      }
      if (!ids.empty()) {
        listed_sizes +=
            fmt::format("[[markers.sizes]]\nids = '''{}'''\nsize_m = {}\n", ids, *size_m);
      }
    }
    return default_size + listed_sizes;
  }

  const toml::table& root_;
  std::string name_;
};

/// Reads one data set; each step fills a part of the result.
class LayoutReader {
 public:
  LayoutReader(const fs::path& path, RigFile rig_file) : rig_file_(rig_file) {
    capture_.path = path;
  }

  Expected<CaptureFolder> read() {
    for (const auto step :
         {&LayoutReader::read_catalog, &LayoutReader::find_tables, &LayoutReader::read_rig_yaml,
          &LayoutReader::guess_rig, &LayoutReader::find_images, &LayoutReader::read_calibration}) {
      if (auto status = (this->*step)(); !status) return tl::make_unexpected(status.error());
    }
    return std::move(capture_);
  }

 private:
  Status read_catalog() {
    const fs::path path = capture_.path / "sfm.toml";
    const auto root = read_toml(path);
    if (!root) return tl::make_unexpected(root.error());
    auto catalog = SfmToml(*root, path.string()).read();
    if (!catalog) return tl::make_unexpected(catalog.error());
    capture_.catalog = std::move(*catalog);
    return {};
  }

  Status find_tables() {
    if (auto path = capture_.path / "detections.csv"; is_there(path))
      capture_.detections_csv = path;
    if (auto path = capture_.path / "survey.toml"; is_there(path)) capture_.survey_toml = path;
    return {};
  }

  Status read_rig_yaml() {
    if (!is_there(capture_.path / "rig.yaml")) return {};
    auto loaded = read_camchain(capture_.path / "rig.yaml");
    if (!loaded) return tl::make_unexpected(loaded.error());
    capture_.rig = std::move(loaded->rig);
    capture_.notes = std::move(loaded->notes);
    return {};
  }

  Status guess_rig() {
    if (rig_file_ == RigFile::required || !capture_.rig.cameras.empty() ||
        is_there(capture_.path / "calib.json")) {
      return {};
    }
    auto rig = rig_of_frames({capture_.path / "images", capture_.detections_csv, false},
                             capture_.catalog, capture_.notes);
    if (!rig) return tl::make_unexpected(rig.error());
    capture_.rig = *std::move(rig);
    return {};
  }

  Status find_images() {
    const fs::path parent = capture_.path / "images";
    if (!is_there(parent)) {
      return capture_.detections_csv
                 ? Status{}
                 : fail(ErrorKind::no_input, "{}: no folder images and no detections.csv",
                        capture_.path.string());
    }
    std::vector<CameraFolder> folders{{0, parent}};
    if (capture_.rig.cameras.size() > 1) {
      const auto found = find_camera_folders(parent, capture_.rig);
      if (!found) return tl::make_unexpected(found.error());
      if (found->empty()) {
        return fail(ErrorKind::bad_data,
                    "{}: rig.yaml names {} cameras; sort their images into {}/cam0, cam1…",
                    capture_.path.string(), capture_.rig.cameras.size(), parent.string());
      }
      folders = *found;
    }
    auto list = list_images(folders);
    if (!list) return tl::make_unexpected(list.error());
    if (list->images.empty() && !capture_.detections_csv) {
      return fail(ErrorKind::no_input, "{}: empty: no jpg, png or pgm", parent.string());
    }
    capture_.images = std::move(list->images);
    capture_.stamps_from_names = list->stamps_from_names;
    std::move(list->notes.begin(), list->notes.end(), std::back_inserter(capture_.notes));
    return {};
  }

  Status read_calibration() {
    if (!capture_.rig.cameras.empty()) return {};
    const fs::path path = capture_.path / "calib.json";
    if (!is_there(path)) {
      return fail(ErrorKind::no_input, "{}: neither rig.yaml nor calib.json",
                  capture_.path.string());
    }
    const auto calib = read_calib_json(path);
    if (!calib) return tl::make_unexpected(calib.error());
    const auto size_px = calib->size_px ? calib->size_px : first_image_size();
    if (!size_px) {
      return fail(ErrorKind::bad_data,
                  "{}: states no width and height, and no image can be read to find them",
                  path.string());
    }
    CameraParameters parameters;
    std::tie(parameters.width_px, parameters.height_px) = *size_px;
    parameters.fu_px = calib->fu_px;
    parameters.fv_px = calib->fv_px;
    parameters.pu_px = calib->pu_px;
    parameters.pv_px = calib->pv_px;
    parameters.distortion = calib->distortion;
    parameters.coefficients = calib->coefficients;
    auto model = CameraModel::create(parameters);
    if (!model) return fail(model.error().kind, "{}: {}", path.string(), model.error().message);
    capture_.rig.cameras.push_back(
        {"cam0", std::move(*model), Rigid3(), "", "", {}, {}, {}, {}, SigmaSource::opencv});
    return check_image_sizes(capture_.rig, path.string());
  }

  [[nodiscard]] std::optional<std::pair<int, int>> first_image_size() const {
    for (const ImageFile& file : capture_.images) {
      if (const auto size = read_image_size(file.path); size && check_image_size(*size, {})) {
        return std::pair(static_cast<int>(size->width_px), static_cast<int>(size->height_px));
      }
    }
    return std::nullopt;
  }

  RigFile rig_file_;
  CaptureFolder capture_;
};

}  // namespace

bool is_paper_layout(const fs::path& path) {
  return is_there(path / "sfm.toml") && !is_there(path / "markers.toml");
}

Expected<CaptureFolder> open_paper_layout(const fs::path& path, RigFile rig_file) {
  return LayoutReader(path, rig_file).read();
}

}  // namespace waymark
