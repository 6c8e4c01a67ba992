#include "mapbuilder/import/survey.h"
#include "tests/fuzz/format.h"

namespace waymark::test {
namespace {

const AddFormat survey_toml(
    {"Survey",
     {"[[points]]\nid = 12\ncorner = \"center\"\nposition_m = [12.4, 3.05, 1.5]\n"
      "sigma_m = 0.002\nuse = \"check\"\n[[distances]]\n"
      "from = { id = 24, corner = \"bottom-left\" }\nto = { id = \"tag36h11:60\" }\n"
      "distance_m = 6.017\nsigma_m = 0.0016\n"},
     {"[[points]]", "[[distances]]", "id", "corner", "\"center\"", "\"top-left\"", "position_m",
      "sigma_m", "use", "\"fit\"", "from", "to", "distance_m", "nan", "inf"},
     reader([](const std::string& text) {
       return parse_survey(text, "survey.toml", Family::tag36h11);
     })});

}  // namespace
}  // namespace waymark::test
