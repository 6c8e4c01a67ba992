#include "mapbuilder/diagnosis/scale_votes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace waymark {
namespace {

/// Two sides agree within so many sigmas of both.
constexpr double kSidesAgree = 5.0;

bool agree(const ScaleWitness& a, const ScaleWitness& b) {
  return std::abs(a.log_scale - b.log_scale) <= kSidesAgree * std::hypot(a.sigma, b.sigma);
}

ScaleParty party_of(const ScaleWitness& centre, const std::vector<ScaleWitness>& all) {
  ScaleParty party;
  double information = 0;
  for (const ScaleWitness& one : all) {
    if (!agree(centre, one)) continue;
    party.members.push_back(one);
    party.weight += one.weight;
    party.log_scale += one.log_scale / (one.sigma * one.sigma);
    information += 1.0 / (one.sigma * one.sigma);
  }
  party.log_scale /= information;
  party.sigma = 1.0 / std::sqrt(information);
  return party;
}

}  // namespace

ScaleParty heaviest_of(std::vector<ScaleWitness> all) {
  std::stable_sort(all.begin(), all.end(),
                   [](const ScaleWitness& a, const ScaleWitness& b) { return a.sigma < b.sigma; });
  ScaleParty best;
  for (const ScaleWitness& centre : all) {
    ScaleParty party = party_of(centre, all);
    if (party.weight > best.weight) best = std::move(party);
  }
  return best;
}

bool holds(const ScaleParty& party, const ScaleWitness& one) {
  return std::any_of(party.members.begin(), party.members.end(), [&](const ScaleWitness& member) {
    return member.side == one.side && member.entry == one.entry;
  });
}

std::string names_of(const std::vector<ScaleWitness>& witnesses) {
  std::vector<std::string> names;
  std::size_t distances = 0;
  for (const ScaleWitness& one : witnesses) {
    if (one.side == ScaleSide::sizes) names.emplace_back("the stated sizes");
    if (one.side == ScaleSide::baselines) names.emplace_back("the rig's baselines");
    if (one.side == ScaleSide::points) names.emplace_back("the survey's points");
    distances += one.side == ScaleSide::distance ? 1 : 0;
  }
  if (distances > 0) {
    names.push_back(fmt::format("{} distance{}", distances, distances == 1 ? "" : "s"));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace waymark
