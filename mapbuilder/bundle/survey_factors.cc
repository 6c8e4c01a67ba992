#include "mapbuilder/bundle/survey_factors.h"

#include <algorithm>
#include <functional>
#include <set>

#include "core/geometry/alignment.h"
#include "core/marker/marker_geometry.h"

namespace waymark {
namespace {

/// The place in the marker frame of a marker of this size (m).
Eigen::Vector3d x_in_marker(const MarkerPlace& place, double size_m) {
  if (!place.corner) return Eigen::Vector3d::Zero();
  return marker_corners(size_m)[static_cast<std::size_t>(*place.corner)];
}

std::optional<MarkerIndex> index_of(const Observations& observations, const MarkerId& marker) {
  const auto& markers = observations.markers.values();
  const auto at = std::lower_bound(markers.begin(), markers.end(), marker);
  if (at == markers.end() || *at != marker) return std::nullopt;
  return MarkerIndex(static_cast<std::size_t>(at - markers.begin()));
}

/// The place in the world; nullopt when its marker has no pose.
std::optional<Eigen::Vector3d> x_in_world(const MarkerPlace& place,
                                          const Observations& observations,
                                          const Calibration& calibration,
                                          const MarkerPoses& world_from_marker) {
  const auto m = index_of(observations, place.marker);
  if (!m || !world_from_marker[*m]) return std::nullopt;
  return *world_from_marker[*m] * x_in_marker(place, calibration.sizes_m[*m]);
}

/// A place within a joint problem: where it stands and how it moves.
struct PlaceInProblem {
  int block = 0;
  SizeClassIndex size_class;
  int size_block = -1;
  Eigen::Vector3d x_in_marker;  ///< at size factor 1

  [[nodiscard]] Eigen::Vector3d at(const BundleVariables& variables) const {
    const double factor = variables.size_factor[size_class];
    return variables.world_from_marker[static_cast<std::size_t>(block)] * (factor * x_in_marker);
  }

  /// Adds d (direction · x_in_world) / d the blocks.
  void add_parts(const BundleVariables& variables,
                 const Eigen::Matrix<double, Eigen::Dynamic, 3>& direction,
                 FactorLinearization& to) const {
    const Rigid3& pose = variables.world_from_marker[static_cast<std::size_t>(block)];
    const double factor = variables.size_factor[size_class];
    const Eigen::Vector3d turned = pose.rotation * x_in_marker;
    Eigen::Matrix<double, Eigen::Dynamic, 6> by_pose(direction.rows(), 6);
    by_pose.leftCols<3>() = direction;
    by_pose.rightCols<3>() = -direction * skew(factor * turned);
    to.parts.push_back({block, by_pose});
    if (size_block >= 0) {
      Eigen::Matrix<double, Eigen::Dynamic, 6> by_size(direction.rows(), 6);
      by_size.setZero();
      by_size.col(0) = direction * turned;
      to.parts.push_back({size_block, by_size});
    }
  }

  void add_blocks(std::vector<int>& blocks) const {
    blocks.push_back(block);
    if (size_block >= 0) blocks.push_back(size_block);
  }
};

std::vector<int> rising(std::vector<int> blocks) {
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

std::optional<PlaceInProblem> place_in(const ReducedProblem& problem,
                                       const Observations& observations,
                                       const Calibration& calibration, const MarkerPlace& place) {
  const auto m = index_of(observations, place.marker);
  const auto block = m ? problem.block_of(*m) : std::nullopt;
  if (!block) return std::nullopt;
  PlaceInProblem result;
  result.block = *block;
  result.size_class = problem.size_class_of(*m);
  result.size_block = problem.layout().size[result.size_class];
  result.x_in_marker = x_in_marker(place, calibration.sizes_m[*m]);
  return result;
}

class PointFactor : public BundleFactor {
 public:
  PointFactor(PlaceInProblem place, const SurveyedPoint& entry) : place_(place), entry_(entry) {}
  [[nodiscard]] std::vector<int> blocks() const override {
    std::vector<int> all;
    place_.add_blocks(all);
    return rising(all);
  }
  [[nodiscard]] FactorLinearization linearize(const BundleVariables& at) const override {
    FactorLinearization result;
    result.residual = (place_.at(at) - entry_.position_m) / entry_.sigma_m;
    place_.add_parts(at, Eigen::Matrix3d::Identity() / entry_.sigma_m, result);
    return result;
  }

 private:
  PlaceInProblem place_;
  SurveyedPoint entry_;
};

class DistanceFactor : public BundleFactor {
 public:
  DistanceFactor(PlaceInProblem from, PlaceInProblem to, const SurveyedDistance& entry)
      : from_(from), to_(to), entry_(entry) {}
  [[nodiscard]] std::vector<int> blocks() const override {
    std::vector<int> all;
    from_.add_blocks(all);
    to_.add_blocks(all);
    return rising(all);
  }
  [[nodiscard]] FactorLinearization linearize(const BundleVariables& at) const override {
    const Eigen::Vector3d apart = to_.at(at) - from_.at(at);
    const double length_m = apart.norm();
    FactorLinearization result;
    result.residual.resize(1);
    result.residual[0] = (length_m - entry_.distance_m) / entry_.sigma_m;
    const Eigen::RowVector3d direction =
        apart.transpose() / (std::max(1e-9, length_m) * entry_.sigma_m);
    to_.add_parts(at, direction, result);
    from_.add_parts(at, -direction, result);
    return result;
  }

 private:
  PlaceInProblem from_;
  PlaceInProblem to_;
  SurveyedDistance entry_;
};

/// A scalar of the calibration, a row of the reduced system, near an expected value.
class ScalarPrior : public BundleFactor {
 public:
  using Value = std::function<double(const BundleVariables&)>;
  /// `slope`: d value / d the row.
  ScalarPrior(int row, Value value, double slope, double expected, double sigma)
      : row_(row), value_(std::move(value)), slope_(slope), expected_(expected), sigma_(sigma) {}
  [[nodiscard]] std::vector<int> blocks() const override { return {row_ / 6}; }
  [[nodiscard]] FactorLinearization linearize(const BundleVariables& at) const override {
    FactorLinearization result;
    result.residual.resize(1);
    result.residual[0] = (value_(at) - expected_) / sigma_;
    Eigen::Matrix<double, Eigen::Dynamic, 6> derivative(1, 6);
    derivative.setZero();
    derivative(0, row_ % 6) = slope_ / sigma_;
    result.parts.push_back({row_ / 6, derivative});
    return result;
  }

 private:
  int row_;
  Value value_;
  double slope_;
  double expected_;
  double sigma_;
};

}  // namespace

MarkerPoses poses_of(const Component& component, const Estimate& estimate) {
  MarkerPoses poses(estimate.world_from_marker.size());
  for (const MarkerIndex m : component.markers) poses[m] = estimate.world_from_marker[m];
  return poses;
}

SurveyReach reach_of(const Survey& survey, const Observations& observations,
                     const Calibration& calibration, const MarkerPoses& world_from_marker) {
  SurveyReach reach;
  for (const SurveyedDistance& distance : survey.distances) {
    if (distance.use == SurveyUse::fit &&
        x_in_world(distance.from, observations, calibration, world_from_marker) &&
        x_in_world(distance.to, observations, calibration, world_from_marker)) {
      reach.scale = true;
    }
  }
  reach.frame =
      facility_from_world(survey, observations, calibration, world_from_marker).has_value();
  reach.scale = reach.scale || reach.frame;
  return reach;
}

std::optional<Rigid3> facility_from_world(const Survey& survey, const Observations& observations,
                                          const Calibration& calibration,
                                          const MarkerPoses& world_from_marker) {
  std::vector<Eigen::Vector3d> in_world;
  std::vector<Eigen::Vector3d> in_facility;
  std::set<MarkerId> markers;
  for (const SurveyedPoint& point : survey.points) {
    if (point.use != SurveyUse::fit) continue;
    const auto x = x_in_world(point.place, observations, calibration, world_from_marker);
    if (!x) continue;
    in_world.push_back(*x);
    in_facility.push_back(point.position_m);
    markers.insert(point.place.marker);
  }
  if (markers.size() < 2) return std::nullopt;
  const auto aligned = align_points(in_world, in_facility, false);
  if (!aligned) return std::nullopt;
  return aligned->motion;
}

std::vector<std::unique_ptr<BundleFactor>> survey_factors(
    const Survey& survey, const Observations& observations, const Calibration& calibration,
    const ReducedProblem& problem, const IndexedVector<MarkerIndex, WorldIndex>& world_of_marker) {
  constexpr WorldIndex kOneWorld(kFacilityWorld.value() + 1);
  const auto world_of = [&](const MarkerPlace& place) {
    const auto index = index_of(observations, place.marker);
    return !index || world_of_marker.empty() ? kOneWorld : world_of_marker[*index];
  };
  std::vector<std::unique_ptr<BundleFactor>> factors;
  for (const SurveyedPoint& point : survey.points) {
    if (point.use != SurveyUse::fit || world_of(point.place) != kFacilityWorld) continue;
    if (const auto place = place_in(problem, observations, calibration, point.place)) {
      factors.push_back(std::make_unique<PointFactor>(*place, point));
    }
  }
  for (const SurveyedDistance& distance : survey.distances) {
    if (distance.use != SurveyUse::fit || world_of(distance.from) != world_of(distance.to)) {
      continue;
    }
    const auto from = place_in(problem, observations, calibration, distance.from);
    const auto to = place_in(problem, observations, calibration, distance.to);
    if (from && to) factors.push_back(std::make_unique<DistanceFactor>(*from, *to, distance));
  }
  return factors;
}

std::unique_ptr<BundleFactor> size_prior(const ReducedLayout& layout, SizeClassIndex size_class,
                                         double already, double sigma) {
  const auto value = [=](const BundleVariables& at) {
    return already * at.size_factor[size_class];
  };
  return std::make_unique<ScalarPrior>(6 * layout.size[size_class], value, already, 1.0, sigma);
}

std::unique_ptr<BundleFactor> edge_bias_prior(const ReducedLayout& layout, CameraIndex camera,
                                              double already_px, double sigma_px) {
  const auto value = [=](const BundleVariables& at) {
    return already_px + at.edge_bias_px[camera];
  };
  return std::make_unique<ScalarPrior>(6 * layout.edge_bias[camera], value, 1.0, 0.0, sigma_px);
}

std::unique_ptr<BundleFactor> intrinsic_prior(const ReducedLayout& layout, CameraIndex camera,
                                              int number, double expected, double sigma) {
  const auto value = [=](const BundleVariables& at) {
    return intrinsics_of(at.cameras[camera].model.parameters())[number];
  };
  return std::make_unique<ScalarPrior>(layout.row_of(camera, number), value, 1.0, expected, sigma);
}

std::vector<SurveyResidual> survey_residuals(const Survey& survey, const Observations& observations,
                                             const Calibration& calibration,
                                             const MarkerPoses& world_from_marker,
                                             bool world_is_facility) {
  const bool with_family = observations.several_families();
  std::vector<SurveyResidual> residuals;
  const auto motion =
      world_is_facility ? std::optional<Rigid3>(Rigid3{})
                        : facility_from_world(survey, observations, calibration, world_from_marker);
  for (const SurveyedPoint& point : survey.points) {
    SurveyResidual residual;
    residual.entry = format_place(point.place, with_family);
    residual.markers = {point.place.marker};
    residual.point = true;
    residual.use = point.use;
    residual.sigma_m = point.sigma_m;
    const auto x = x_in_world(point.place, observations, calibration, world_from_marker);
    residual.mapped = x.has_value() && motion.has_value();
    if (residual.mapped) residual.residual_m = (*motion * *x - point.position_m).norm();
    residuals.push_back(residual);
  }
  for (const SurveyedDistance& distance : survey.distances) {
    SurveyResidual residual;
    residual.entry =
        format_place(distance.from, with_family) + " – " + format_place(distance.to, with_family);
    residual.markers = {distance.from.marker, distance.to.marker};
    residual.use = distance.use;
    residual.measured_m = distance.distance_m;
    residual.sigma_m = distance.sigma_m;
    const auto from = x_in_world(distance.from, observations, calibration, world_from_marker);
    const auto to = x_in_world(distance.to, observations, calibration, world_from_marker);
    residual.mapped = from && to;
    if (residual.mapped) residual.residual_m = (*to - *from).norm() - distance.distance_m;
    residuals.push_back(residual);
  }
  return residuals;
}

}  // namespace waymark
