#include "mapbuilder/report/report.h"

namespace waymark {

bool Report::several_families() const {
  MeetingFamilies families = map.families();
  for (const MarkerId& id : unmapped) families.add(id.family);
  for (const Finding& finding : findings) {
    for (const MarkerId& id : finding.markers) families.add(id.family);
  }
  return families.several();
}

}  // namespace waymark
