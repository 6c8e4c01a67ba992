#include "core/geometry/tum.h"

#include "tests/fuzz/format.h"

namespace waymark::test {
namespace {

/// With its keys as the stamps of a trajectory.
Expected<std::vector<Stamp>> read(const std::string& text) {
  const auto poses = parse_tum(text, "rig.tum");
  if (!poses) return tl::make_unexpected(poses.error());
  std::vector<Stamp> stamps;
  for (const TumPose& pose : *poses) {
    const auto stamp = parse_stamp_s(pose.key);
    if (!stamp) return tl::make_unexpected(stamp.error());
    stamps.push_back(*stamp);
  }
  return stamps;
}

const AddFormat tum({"Tum",
                     {"# t_s tx ty tz qx qy qz qw\n1511000000.000000000 1.5 -2 0.25 0 0 0 1\n"
                      "-1.5 0 0 0 0.5 0.5 0.5 0.5\r\n.25\t1e-3 +2 0 0 0 -0.7071 0.7071 # end\n"},
                     {"nan", "inf", "1e308", "9200000001", "#", "\r\n"},
                     reader(read)});

}  // namespace
}  // namespace waymark::test
