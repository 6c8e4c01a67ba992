#include "mapbuilder/observations/selection.h"

#include "mapbuilder/observations/covisibility.h"

namespace waymark {

Selection::Selection(const Observations& observations, const Corrections& corrections)
    : observations_(&observations),
      corrections_(corrections),
      used_of_(observations.markers.size()),
      stated_sizes_m_(observations.stated_sizes_m),
      component_of_(observations.frame_sets.size()) {
  for (const ObservationIndex index : IndexRange<ObservationIndex>(
           observations.usable, observations.all.size() - observations.usable)) {
    unused_.push_back(index);
  }
  for (const ObservedFrameSet& set : observations.frame_sets) {
    first_in_.push_back(used_.size());
    for (const ObservationIndex index : set.observations) {
      if (corrections.left_out.contains(index)) {
        unused_.push_back(index);
        continue;
      }
      used_.push_back(index);
      used_of_[observations[index].marker].push_back(index);
    }
  }
  first_in_.push_back(used_.size());
  for (const auto& [marker, size_m] : corrections.sizes_m) stated_sizes_m_[marker] = size_m;
  components_ = IndexedVector<ComponentIndex, Component>(connected_components(observations, used_));
  for (const ComponentIndex c : components_.indices()) {
    for (const FrameSetIndex f : components_[c].frame_sets) component_of_[f] = c;
  }
}

std::span<const ObservationIndex> Selection::used_in(FrameSetIndex frame_set) const {
  const std::size_t first = first_in_[frame_set];
  const std::size_t end = first_in_[FrameSetIndex(frame_set.value() + 1)];
  return std::span(used_).subspan(first, end - first);
}

std::vector<ObservationIndex> Selection::used_in(std::span<const FrameSetIndex> frame_sets) const {
  std::vector<ObservationIndex> all;
  for (const FrameSetIndex frame_set : frame_sets) {
    const auto own = used_in(frame_set);
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

}  // namespace waymark
