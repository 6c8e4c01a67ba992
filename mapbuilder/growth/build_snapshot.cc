#include "mapbuilder/growth/build_snapshot.h"

namespace waymark {

BuildSnapshot::BuildSnapshot(JointBuild& build)
    : build_(build), table_(build.table()), state_(build.state()), scope_(build.scope()) {
  for (const ComponentGrowth* part : build.parts()) {
    parts_.push_back({part->noise(), part->settled()});
  }
}

void BuildSnapshot::restore() {
  build_.table() = std::move(table_);
  build_.state() = std::move(state_);
  build_.set_scope(std::move(scope_));
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    build_.parts()[i]->set_noise(parts_[i].noise);
    build_.parts()[i]->set_settled(parts_[i].settled);
  }
}

}  // namespace waymark
