#pragma once

#include <map>
#include <set>

#include "mapbuilder/diagnosis/marker_diagnosis.h"

namespace waymark {

/// What a diagnosis changes in the table so that what is wrong can't harm the rest.
struct TableCorrections {
  std::set<std::size_t> left_out;  ///< indices of observations
  std::map<int, double> sizes_m;   ///< by marker of the table
  [[nodiscard]] bool empty() const { return left_out.empty() && sizes_m.empty(); }
};

/// Wrong ids are left out; so is a marker that stands twice, or as much of it as belongs to the
/// place that the map does not keep; wrong sizes are replaced by the fitted ones.
void add_corrections(const ObservationTable& table, const MarkerDiagnosis& diagnosis,
                     TableCorrections& corrections);

/// The table with the corrections made.
[[nodiscard]] ObservationTable corrected(const ObservationTable& table,
                                         const TableCorrections& corrections);

}  // namespace waymark
