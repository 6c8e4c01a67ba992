#include "locd/service/config.h"
#include "tests/fuzz/format.h"

namespace waymark::test {
namespace {

const AddFormat config_toml(
    {"Config",
     {"[map]\npath = \"hall.map\"\n[rig]\ncamchain = \"rig.yaml\"\n"
      "base_from_rig = [[1, 0, 0, 0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
      "[[camera]]\nname = \"cam0\"\ndriver = \"v4l2\"\ndevice = \"serial=0042\"\n"
      "format = \"GREY\"\nfps = 30\nexposure_us = 800\ngain = 2.5\nreadout_us = 0\n"
      "stamp_delay_us = -120\n"
      "[sync]\nmode = \"free\"\ntolerance_us = 20000\ndeadline_ms = 25\nmin_cameras = 1\n"
      "[solve]\ntime_budget_ms = 100\nok_sigma_m = 0.02\nv_max_mps = 3.0\n"
      "[lcm]\nurl = \"udpm://239.255.76.67:7667?ttl=0\"\nchannel_prefix = \"WAYMARK\"\n"
      "[record]\ndir = \"rec\"\ncodec = \"pgm\"\nevery_nth = 2\nmax_bytes = 1000000\n"
      "[service]\nstartup_wait_s = 5.0\nrealtime = false\nlock_memory = false\n"},
     {"[map]", "[rig]", "[[camera]]", "[sync]", "[solve]", "[lcm]", "[record]", "[service]",
      "base_from_rig", "\"libcamera\"", "\"replay\"", "udpm://", "?ttl=", "memq://", "nan", "inf",
      "1e308", "9223372036854775807", "1979-05-27T07:32:00Z"},
     reader([](const std::string& text) { return parse_config(text, "locd.toml"); })});

}  // namespace
}  // namespace waymark::test
