#include "core/base/cause.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace waymark {
namespace {

using enum Cause;

constexpr std::array<CauseText, 44> kCauses{{
    {stamps, "stamps", "input",
     "Stamps are no nanoseconds of one clock: seconds, microseconds, frame numbers, all zero.",
     "Their size and steps, before anything is built.",
     "Write nanoseconds; name images by the stamp of their exposure, not by their number."},
    {csv, "csv", "input",
     "A table of detections that can't be meant as it is read: another separator or encoding, rows "
     "twice, corners in another order.",
     "Header, rows and the way the corners run round.",
     "Write comma-separated UTF-8 with corners top-left, top-right, bottom-right, bottom-left."},
    {format, "format", "input",
     "A file of another program where one of ours is expected: a camera_info, an OpenCV storage.",
     "Its keys.", "Write rig.yaml as the message says, or use a file that is read as it is."},
    {family, "family", "input",
     "Markers of another family hang there than markers.toml states, or two stated families hold "
     "the "
     "same codes.",
     "Squares in a sample of the images read as codes of that family, far more often than by "
     "chance.",
     "State the family that the message names."},
    {unlisted_ids, "unlisted_ids", "input",
     "Markers of a stated family are seen whose ids markers.toml neither sizes nor ignores.",
     "They are read in images or detections and left out.",
     "Give them a size, or put them into `ignore`."},
    {mirrored, "mirrored", "input", "Images, or prints, are mirrored left-right.",
     "Squares in a sample of the images read as codes only when they are mirrored.",
     "Switch the mirroring off in the driver and record again; hang prints with the right side "
     "out."},
    {inverted_print, "inverted_print", "input", "Markers are printed white on black.",
     "Squares read as codes only when black and white change places.",
     "Print them black on white."},
    {border, "border", "input",
     "The black border is not one cell wide: two cells (Kalibr's AprilGrid), or cut.",
     "Squares read as codes only with such a border.",
     "Print with a border of one cell; where it was cut, measure the size of what is left."},
    {margin, "margin", "input",
     "Dark squares have no white margin: outline and background run together.",
     "Codes are read from the white cells inside, while no outline is found around them.",
     "Put white paper of a cell's width around every marker."},
    {dark, "dark", "input", "Images are nearly black, or hold few bits in a large range.",
     "Mean and largest grey value.",
     "Expose longer, add light, take off the cap; write all bits at the upper end."},
    {blind_camera, "blind_camera", "input",
     "A camera of rig.yaml contributes nothing: no images, or no marker in any.",
     "Its count of markers, while the others see some.",
     "Look at its images; its place in rig.yaml could not be checked."},

    {clock, "clock", "time", "A camera's stamps are another clock's, early, late, or drifting.",
     "No frame set holds it, or its error grows with the speed.",
     "Let all cameras stamp by one clock; trigger them together."},
    {frame_order, "frame_order", "time",
     "Images were paired by number and one was lost: later pairs show different moments.",
     "From one frame set on a camera shows what the others saw a frame later or earlier.",
     "Pair by stamp, or remove the images from there on."},

    {rig_inverted, "rig_inverted", "rig", "T_cn_cnm1 is written the other way round.",
     "Every camera alone fits, all together fit with the inverse transform.",
     "Invert the transform in rig.yaml: camera n from camera n-1."},
    {rig_unit, "rig_unit", "rig", "Translations in rig.yaml are not metres.",
     "Lengths that no rig has, or baselines that the cameras' own motion shows to be 1000, 100, "
     "39.4 "
     "or 3.28 times shorter.",
     "Write metres."},
    {rig_turned, "rig_turned", "rig",
     "A camera is stated turned by 90 or 180 degrees about its axis.",
     "Every camera alone fits, all together fit with the turned one.",
     "Correct its rotation in rig.yaml."},
    {rig_exchanged, "rig_exchanged", "rig", "Two cameras, or their folders, are exchanged.",
     "Every camera alone fits, all together fit when the two change places.",
     "Exchange plugs or folders; name cameras by serial number."},
    {rig_displaced, "rig_displaced", "rig", "A camera stands elsewhere than rig.yaml says.",
     "The images of all cameras together put it there, by more than five standard deviations.",
     "See whether it was moved; calibrate the rig anew, or build with --refine extrinsics."},
    {rig_bumped, "rig_bumped", "rig", "A camera was displaced during the capture.",
     "It fits rig.yaml before a moment and another place after it.",
     "Fasten it; use the half that the message names."},

    {intrinsics, "intrinsics", "lens",
     "Focal length, principal point or lens do not fit the images.",
     "The images of that camera fit other numbers, by more than chance.",
     "Check the order fu fv pu pv; calibrate anew, or build with --refine intrinsics."},
    {resolution, "resolution", "lens",
     "The calibration is of another resolution, or images were scaled.",
     "The focal length fits at a simple factor, or unequally across and down.",
     "Calibrate at the size that is recorded."},
    {crop, "crop", "lens", "Images are a crop of those that were calibrated.",
     "Focal length fits, the principal point lies elsewhere.",
     "Calibrate the crop, or shift the principal point by its offset."},
    {rectified, "rectified", "lens", "Rectified images with the raw lens's calibration.",
     "They fit a lens without distortion.",
     "State distortion_model none and the rectified intrinsics."},
    {images_turned, "images_turned", "lens", "The driver turns images against the calibration.",
     "The principal point, or the whole rig, fits turned by 180 degrees.",
     "Switch the turning off, or calibrate with it."},
    {response, "response", "lens", "Grey values are not proportional to light.",
     "Edges are seen shifted by blur.", "State `response` in rig.yaml."},

    {size_scale, "size_scale", "size", "All stated sizes are too large or too small by one factor.",
     "Sizes against the rig's baselines, or against the survey.",
     "Measure the outer edge of a marker's black border; then check the baselines."},
    {size, "size", "size", "One marker, or a group, is of another size than stated.",
     "Views by cameras that other markers place fit another size.",
     "Measure its black border and correct markers.toml."},
    {print_not_square, "print_not_square", "size", "Markers are narrower than high, or bent.",
     "They are seen so in every view.",
     "Measure both edges; print without scaling; hang them flat."},

    {wrong_id, "wrong_id", "markers", "Detections carry an id that does not belong there.",
     "They contradict where that marker stands; often another one stands there.",
     "Nothing, if it is rare; else clean or replace the markers that are misread."},
    {twin, "twin", "markers", "An id hangs twice in the building.",
     "It is seen at two places, at once or in turn.",
     "Take one of them down or give it another id, then record again."},
    {moved, "moved", "markers", "A marker stands elsewhere than before.",
     "Views before and after place it differently; or an earlier map, or a vehicle, has it "
     "elsewhere.",
     "Nothing, if it stays there; waypoints that hang on its old place are stale."},
    {moving_group, "moving_group", "markers", "Markers move together: a board, a shelf, a door.",
     "Against each other they stand still, against the building they don't.",
     "Keep boards out of captures; state a `group` in markers.toml."},
    {riding, "riding", "markers", "A marker rides on the vehicle itself.",
     "A camera sees it always at one place.", "Put it into `ignore` in markers.toml."},
    {few_views, "few_views", "markers",
     "Too few views, or views too much alike, to fix what is asked for.",
     "Markers of one view, markers and frame sets without a pose, refinements that are refused.",
     "Record more views: several markers in each, from many sides and distances."},

    {disconnected, "disconnected", "map", "Parts of the building share no marker.",
     "No frame set sees markers of two of them.", "Record a capture that sees markers of both."},
    {other_place, "other_place", "map",
     "Captures, or a capture and a map, are of different places.",
     "The same ids stand differently to each other.",
     "Give the halls ids of their own; name the map of this building."},
    {map_misfit, "map_misfit", "map", "Map and images do not fit each other as a whole.",
     "Corners are far off, and no other cause explains it.",
     "Check rig.yaml, and sizes and ids in markers.toml; of a map by hand, its units and axes."},
    {map_entry, "map_entry", "map", "One entry of a map made by hand is wrong.",
     "The capture puts that marker elsewhere, the others fit.", "Measure it again."},
    {not_level, "not_level", "map", "Nothing tells where up is.",
     "The markers' normals leave it open.",
     "Level by walls that face different ways, by floor markers and upright cameras, or by survey "
     "points."},
    {scale_unknown, "scale_unknown", "map",
     "No measured length tells the scale beyond the stated sizes.",
     "How sure rig and sizes are stated to be, and what that does to it.",
     "Measure a distance on site (survey.toml) where that matters."},

    {survey_unit, "survey_unit", "survey", "The survey's lengths are not metres.",
     "All are off by one factor.", "Write metres."},
    {survey_mirrored, "survey_mirrored", "survey",
     "The survey is left-handed: one axis runs the other way.", "Its mirror image fits.",
     "Turn the axis round."},
    {survey_entry, "survey_entry", "survey",
     "Entries contradict the others or the images, or too few fix the frame.",
     "Their residuals in standard deviations.",
     "Measure them again; if they stand, look at sizes and calibration."},
    {survey_corner, "survey_corner", "survey",
     "A point was measured at another corner than stated.",
     "It fits another corner of the same marker.", "State the corner that was measured."},
}};

constexpr bool each_cause_stands_at_its_number() {
  for (std::size_t i = 0; i < kCauses.size(); ++i) {
    if (static_cast<std::size_t>(kCauses[i].cause) != i) return false;
  }
  return static_cast<std::size_t>(survey_corner) + 1 == kCauses.size();
}
static_assert(each_cause_stands_at_its_number());

}  // namespace

std::span<const CauseText> all_causes() { return kCauses; }

const CauseText& text_of(Cause cause) { return kCauses[static_cast<std::size_t>(cause)]; }

std::optional<Cause> cause_from_name(std::string_view name) {
  const auto* found = std::find_if(kCauses.begin(), kCauses.end(),
                                   [&](const CauseText& text) { return text.name == name; });
  if (found == kCauses.end()) return std::nullopt;
  return found->cause;
}

}  // namespace waymark
