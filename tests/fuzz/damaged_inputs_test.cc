// Whatever is read from outside, damaged thousands of times: no crash, no endless loop (ctest's
// time limit), no memory beyond reason, and for each refusal one line that says something. The asan
// and ubsan presets see what a plain build survives by luck.
#include <gtest/gtest.h>

#include <functional>

#include "core/camera/kalibr.h"
#include "core/capture/jpeg.h"
#include "core/capture/pgm.h"
#include "core/capture/png.h"
#include "core/map/map_file.h"
#include "core/map/map_json.h"
#include "core/map/map_records.h"
#include "core/marker/marker_catalog.h"
#include "locd/service/config.h"
#include "mapbuilder/import/calib_json.h"
#include "mapbuilder/import/survey.h"
#include "tests/fuzz/mutator.h"
#include "tests/support/small_map.h"
#include "tests/support/tiny_capture.h"

namespace waymark {
namespace {

/// What became of one input: nullopt when it was taken.
using Reader = std::function<std::optional<Error>(const std::string&)>;

template <typename Read>
Reader reader(Read read) {
  return [read](const std::string& input) -> std::optional<Error> {
    const auto result = read(input);
    if (result) return std::nullopt;
    return result.error();
  };
}

struct Format {
  std::string name;
  std::vector<std::string> seeds;
  Reader read;
  int inputs = 4000;
};

std::string encoded(const Expected<std::string>& bytes) { return bytes.value(); }

GrayImage image() {
  GrayImage drawn(40, 30, 128);
  for (std::size_t i = 0; i < drawn.pixels.size(); ++i) {
    drawn.pixels[i] = static_cast<std::uint8_t>(i * i / 7);
  }
  return drawn;
}

const char* const kConfig =
    "[map]\npath = \"hall.map\"\n[rig]\ncamchain = \"rig.yaml\"\n"
    "base_from_rig = [[1, 0, 0, 0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
    "[[camera]]\nname = \"cam0\"\ndriver = \"v4l2\"\ndevice = \"serial=0042\"\nformat = \"GREY\"\n"
    "fps = 30\nexposure_us = 800\ngain = 2.5\nreadout_us = 0\nstamp_delay_us = -120\n"
    "[sync]\nmode = \"free\"\ntolerance_us = 20000\ndeadline_ms = 25\nmin_cameras = 1\n"
    "[solve]\ntime_budget_ms = 100\nok_sigma_m = 0.02\nv_max_mps = 3.0\n"
    "[lcm]\nurl = \"udpm://239.255.76.67:7667?ttl=0\"\nchannel_prefix = \"WAYMARK\"\n"
    "[record]\ndir = \"rec\"\ncodec = \"pgm\"\nevery_nth = 2\nmax_bytes = 1000000\n"
    "[service]\nstartup_wait_s = 5.0\nrealtime = false\nlock_memory = false\n";

const char* const kSurvey =
    "[[points]]\nid = 12\ncorner = \"center\"\nposition_m = [12.4, 3.05, 1.5]\nsigma_m = 0.002\n"
    "use = \"check\"\n[[distances]]\nfrom = { id = 24, corner = \"bottom-left\" }\n"
    "to = { id = \"tag36h11:60\" }\ndistance_m = 6.017\nsigma_m = 0.0016\n";

const char* const kCalib =
    "{\"camera_matrix\": [[600, 0, 320], [0, 610, 240], [0, 0, 1]], \"dist\": [0.1, -0.2, 0, 0], "
    "\"width\": 640, \"height\": 480}";

std::vector<Format> formats() {
  const MarkerMap map = test::small_map();
  const std::string rig = tiny_rig_yaml(3);
  return {
      {"MapFile", {encoded(encode_map(map))}, reader([](const std::string& s) {
         return decode_map(s, "hall.map");
       })},
      {"MapRecords", {encode_records(map)}, reader([](const std::string& s) {
         return decode_records(s, kMapContainerVersion);
       })},
      {"MapJson",
       {format_map_json(map)},
       reader([](const std::string& s) { return parse_map_json(s, "map.json"); }),
       1000},
      {"Camchain",
       {rig},
       reader([](const std::string& s) { return parse_camchain(s, "rig.yaml"); }),
       2000},
      {"MarkerCatalog", {tiny_markers_toml()}, reader([](const std::string& s) {
         return parse_marker_catalog(s, "markers.toml");
       })},
      {"Config", {kConfig}, reader([](const std::string& s) {
         return parse_config(s, "locd.toml");
       })},
      {"Survey", {kSurvey}, reader([](const std::string& s) {
         return parse_survey(s, "survey.toml", Family::tag36h11);
       })},
      {"CalibJson", {kCalib}, reader([](const std::string& s) {
         return parse_calib_json(s, "calib.json");
       })},
      {"Jpeg",
       {encoded(encode_jpeg(image().view(), 90)), encoded(encode_jpeg(image().view(), 20))},
       reader([](const std::string& s) { return decode_jpeg(s); })},
      {"Png", {encoded(encode_png(image().view()))}, reader([](const std::string& s) {
         return decode_png(s);
       })},
      {"Pgm", {encode_pgm(image().view())}, reader([](const std::string& s) {
         return decode_pgm(s);
       })},
  };
}

class DamagedInputs : public testing::TestWithParam<Format> {};

TEST_P(DamagedInputs, AreTakenOrRefusedInOneLine) {
  const Format& format = GetParam();
  for (const std::string& seed : format.seeds) {
    const auto refused = format.read(seed);
    ASSERT_FALSE(refused) << refused->message;
  }
  test::Mutator mutator(format.seeds, 20260101);
  int refusals = 0;
  for (int i = 0; i < format.inputs; ++i) {
    const auto refused = format.read(mutator.next());
    if (!refused) continue;
    ++refusals;
    EXPECT_FALSE(refused->message.empty()) << i;
    EXPECT_EQ(refused->message.find('\n'), std::string::npos) << refused->message;
  }
  EXPECT_GT(refusals, format.inputs / 10) << "damage that nobody notices is no test";
}

INSTANTIATE_TEST_SUITE_P(Formats, DamagedInputs, testing::ValuesIn(formats()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace waymark
