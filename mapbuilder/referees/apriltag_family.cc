#include "mapbuilder/referees/apriltag_family.h"

#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>

#include <algorithm>

namespace waymark {
namespace {

constexpr ApriltagFamily kFamilies[] = {
    {Family::tag16h5, tag16h5_create, tag16h5_destroy},
    {Family::tag25h9, tag25h9_create, tag25h9_destroy},
    {Family::tag36h10, tag36h10_create, tag36h10_destroy},
    {Family::tag36h11, tag36h11_create, tag36h11_destroy},
    {Family::tagstandard41h12, tagStandard41h12_create, tagStandard41h12_destroy},
    {Family::tagstandard52h13, tagStandard52h13_create, tagStandard52h13_destroy},
    {Family::tagcircle21h7, tagCircle21h7_create, tagCircle21h7_destroy},
    {Family::tagcircle49h12, tagCircle49h12_create, tagCircle49h12_destroy},
    {Family::tagcustom48h12, tagCustom48h12_create, tagCustom48h12_destroy},
};

}  // namespace

const ApriltagFamily* apriltag_family(Family family) {
  const auto* const found =
      std::find_if(std::begin(kFamilies), std::end(kFamilies),
                   [&](const ApriltagFamily& candidate) { return candidate.family == family; });
  return found != std::end(kFamilies) ? found : nullptr;
}

}  // namespace waymark
