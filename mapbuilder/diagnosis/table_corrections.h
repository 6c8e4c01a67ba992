#pragma once

#include <map>
#include <set>
#include <span>
#include <vector>

#include "mapbuilder/diagnosis/marker_diagnosis.h"

namespace waymark {

/// What a diagnosis changes in the table so that what is wrong can't harm the rest.
struct TableCorrections {
  std::set<std::size_t> left_out;  ///< observations of the table as it was given
  std::map<int, double> sizes_m;   ///< by marker of the table
};

/// A table with corrections made: what is left out joins the repeated observations, which no map is
/// built on but every diagnosis judges.
struct CorrectedTable {
  ObservationTable table;
  /// Of each of its observations, then of its repeated ones, as MarkerView::index counts: the index
  /// in the given table, counted alike.
  std::vector<std::size_t> given_index;
};

/// Wrong ids are left out; so is a marker that stands twice, or as much of it as belongs to the
/// place that the map does not keep; wrong sizes are replaced by the fitted ones. The diagnosis is
/// one of `corrected`; the corrections are of the table that it was made from.
[[nodiscard]] TableCorrections corrections_for(const CorrectedTable& corrected,
                                               std::span<const MarkerDiagnosis> diagnoses);

/// The table as it is given.
[[nodiscard]] CorrectedTable uncorrected(ObservationTable given);

/// The given table with the corrections made.
[[nodiscard]] CorrectedTable correct(const ObservationTable& given,
                                     const TableCorrections& corrections);

}  // namespace waymark
