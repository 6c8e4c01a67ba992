#pragma once

#include <apriltag/apriltag.h>

#include "core/marker/family.h"

namespace waymark {

/// One of libapriltag's families and how it is made.
struct ApriltagFamily {
  Family family;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

/// nullptr for a family that libapriltag does not have.
[[nodiscard]] const ApriltagFamily* apriltag_family(Family family);

}  // namespace waymark
