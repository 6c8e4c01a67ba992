#include "mapbuilder/diagnosis/print_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/marker/marker_geometry.h"
#include "tests/support/synthetic_room.h"

namespace waymark {
namespace {

constexpr double kNoise_px = 0.1;
constexpr double kStated_m = 0.2;

/// One print seen by cameras all around it.
class Prints : public ::testing::Test {
 protected:
  /// Views of a print of that shape, with noise.
  std::vector<MarkerView> views_of(const PrintedPose& truth, int count, double noise_px) {
    observations_.assign(static_cast<std::size_t>(count), {});
    std::vector<MarkerView> views;
    std::normal_distribution<double> noise(0, noise_px);
    for (int i = 0; i < count; ++i) {
      const double round = 0.9 * i;
      // Looks at the marker, which looks along z, from 2 m off and up to 40° aside.
      const Rigid3 world_from_cam{
          so3_exp({0.6 * std::sin(round), 0.6 * std::cos(round), 0.3 * i}) * so3_exp({M_PI, 0, 0}),
          {}};
      MarkerView view;
      view.camera = &camera_;
      view.world_from_cam = world_from_cam;
      view.world_from_cam.translation = world_from_cam.rotation * Eigen::Vector3d(0, 0, -2);
      MarkerObservation& o = observations_[static_cast<std::size_t>(i)];
      o.size_m = kStated_m;
      auto corners = marker_corners(kStated_m * truth.factor);
      for (std::size_t c = 0; c < 4; ++c) {
        corners[c].x() *= std::exp(0.5 * truth.stretch);
        corners[c].y() *= std::exp(-0.5 * truth.stretch);
        o.corners_px[c] = *camera_.model.project(view.world_from_cam.inverse() *
                                                 (truth.world_from_marker * corners[c]));
        o.corners_px[c] += Eigen::Vector2d(noise(random_), noise(random_));
        o.whitening[c] = Eigen::Matrix2d::Identity() / kNoise_px;
      }
      view.observation = &o;
      views.push_back(view);
    }
    return views;
  }

  std::mt19937 random_{5};
  RigCamera camera_ = test::ring_rig(1).cameras.front();
  std::vector<MarkerObservation> observations_;
  PrintedPose truth_{{so3_exp({0.1, -0.05, 0.4}), {0.05, -0.03, 0.02}}, 0.97, -0.06};
};

TEST_F(Prints, AreFoundExactlyWhereNothingIsNoisy) {
  const auto views = views_of(truth_, 12, 0);
  const auto fit = fit_print(views, {}, FreePrint::size_and_stretch, {});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->place.factor, truth_.factor, 1e-6);
  EXPECT_NEAR(fit->place.stretch, truth_.stretch, 1e-6);
  EXPECT_LT(
      (fit->place.world_from_marker.translation - truth_.world_from_marker.translation).norm(),
      1e-6);
}

TEST_F(Prints, KeepTheStretchThatIsHeld) {
  PrintedPose square = truth_;
  square.stretch = 0;
  const auto views = views_of(square, 12, 0);
  const auto fit = fit_print(views, {}, FreePrint::size, {});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->place.factor, square.factor, 1e-6);
  EXPECT_EQ(fit->place.stretch, 0);
  EXPECT_EQ(fit->stretch_sigma, 0);
}

TEST_F(Prints, AreAsSureAsStated) {
  constexpr int kDraws = 300;
  double factor2 = 0;
  double stretch2 = 0;
  for (int i = 0; i < kDraws; ++i) {
    const auto views = views_of(truth_, 12, kNoise_px);
    const auto fit = fit_print(views, {}, FreePrint::size_and_stretch, {Loss::squared});
    ASSERT_TRUE(fit);
    factor2 += std::pow((fit->place.factor / truth_.factor - 1) / fit->factor_sigma, 2) / kDraws;
    stretch2 += std::pow((fit->place.stretch - truth_.stretch) / fit->stretch_sigma, 2) / kDraws;
  }
  EXPECT_GT(factor2, 0.75);
  EXPECT_LT(factor2, 1.25);
  EXPECT_GT(stretch2, 0.75);
  EXPECT_LT(stretch2, 1.25);
}

TEST_F(Prints, SayThatOneFrontalViewHardlyTellsThem) {
  const auto sigma_by = [&](int views) {
    const auto fit =
        fit_print(views_of(truth_, views, kNoise_px), {}, FreePrint::size_and_stretch, {});
    return fit ? fit->factor_sigma : std::numeric_limits<double>::infinity();
  };
  EXPECT_GT(sigma_by(1), 10 * sigma_by(12));
}

TEST_F(Prints, MissTheirViewsByNothingWhereTheyAre) {
  const auto views = views_of(truth_, 3, 0);
  PrintedPose square = truth_;
  square.stretch = 0;
  for (const MarkerView& view : views) {
    EXPECT_NEAR(misfit_sigmas2(view, truth_), 0, 1e-9);
    EXPECT_GT(misfit_sigmas2(view, square), 100);
  }
}

}  // namespace
}  // namespace waymark
