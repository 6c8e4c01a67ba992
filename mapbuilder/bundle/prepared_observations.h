#pragma once

#include <memory>

#include "mapbuilder/bundle/estimate.h"

namespace waymark {

/// The observations as an estimate has them: corners without edge bias, effective sizes, whitening,
/// IPPE solutions. What observations and estimate say together and nothing else, kept because it is
/// costly: `update` computes anew only what another estimate changes. The selection must outlive
/// it.
class PreparedObservations {
 public:
  /// Whether IPPE solutions are wanted: only what seeds poses asks for them.
  enum class Ippe { none, solved };

  PreparedObservations(const Selection& selection, const Estimate& estimate, int threads);

  /// Without solutions, those of an earlier calibration are gone.
  void update(const Estimate& estimate, Ippe ippe = Ippe::solved);

  [[nodiscard]] const MarkerObservation& operator[](ObservationIndex index) const {
    return prepared_[index];
  }
  [[nodiscard]] const Selection& selection() const { return *selection_; }
  [[nodiscard]] const Observations& observations() const { return selection_->observations(); }

 private:
  void take_calibration(const Calibration& calibration);
  void solve_ippe_of_all();
  void take_noise(ComponentIndex component, const NoiseModel& noise);

  const Selection* selection_;
  int threads_;
  Calibration calibration_;
  bool ippe_solved_ = false;
  IndexedVector<ComponentIndex, NoiseModel> noise_;
  IndexedVector<ComponentIndex, std::vector<ObservationIndex>> observations_of_;
  IndexedVector<ObservationIndex, MarkerObservation> prepared_;
};

}  // namespace waymark
