#include "mapbuilder/diagnosis/rig_judge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "tests/mapbuilder/diagnosis/simulated_tracks.h"

namespace waymark {
namespace {

using tests::drive_tracks;
using tests::ring_of_cameras;
using tests::SimulatedDrive;
using tests::turned_by;

Rig rig_of(const Extrinsics& places) {
  Rig rig;
  for (std::size_t k = 0; k < places.size(); ++k) {
    CameraParameters p;
    p.fu_px = p.fv_px = 800;
    p.pu_px = 640;
    p.pv_px = 512;
    p.width_px = 1280;
    p.height_px = 1024;
    rig.cameras.push_back(
        {"cam" + std::to_string(k), *CameraModel::create(p), places[k], "", "", {}, {}, {}});
  }
  return rig;
}

/// Rigs of two to four cameras, close together and all around.
struct RigKind {
  std::size_t cameras;
  double step_deg;
};
const RigKind kRigs[] = {{2, 60}, {3, 60}, {3, 110}, {4, 85}, {2, 150}};
constexpr unsigned kSeeds = 3;

/// A rig as a calibration leaves it: half a millimetre and a fortieth of a degree off.
Extrinsics calibrated(const Extrinsics& truth, unsigned seed) {
  std::mt19937 random(1000 + seed);
  std::normal_distribution<double> normal;
  Extrinsics stated = truth;
  for (std::size_t k = 1; k < stated.size(); ++k) {
    Vector6d delta;
    for (int i = 0; i < 3; ++i) {
      delta[i] = 0.0005 * normal(random);
      delta[i + 3] = 0.0004 * normal(random);
    }
    stated[k] = stated[k].plus(delta);
  }
  return stated;
}

template <typename Body>
void for_rigs(const Body& body) {
  for (const RigKind& kind : kRigs) {
    for (unsigned seed = 0; seed < kSeeds; ++seed) {
      SCOPED_TRACE(testing::Message()
                   << kind.cameras << " cameras every " << kind.step_deg << "°, seed " << seed);
      SimulatedDrive drive;
      drive.seed = seed;
      const Extrinsics truth = ring_of_cameras(kind.cameras, kind.step_deg);
      body(drive, truth, calibrated(truth, seed), seed);
    }
  }
}

TEST(RigHypotheses, ASoundRigIsNotAccused) {
  for_rigs(
      [](const SimulatedDrive& drive, const Extrinsics& truth, const Extrinsics& stated, unsigned) {
        const auto found = explain_rig(drive_tracks(drive, truth), rig_of(stated));
        EXPECT_FALSE(found) << found->detail;
      });
}

TEST(RigHypotheses, AChainWrittenTheOtherWayRoundIsToldAsThat) {
  for_rigs([](const SimulatedDrive& drive, const Extrinsics& truth,
              const Extrinsics& calibrated_rig, unsigned) {
    Extrinsics stated = calibrated_rig;
    for (std::size_t n = 1; n < stated.size(); ++n) {
      const Rigid3 link = calibrated_rig[n - 1].inverse() * calibrated_rig[n];
      stated[n] = stated[n - 1] * link.inverse();
    }
    const auto found = explain_rig(drive_tracks(drive, truth), rig_of(stated));
    ASSERT_TRUE(found);
    // Of two cameras the inverse chain is also one with the two exchanged.
    EXPECT_TRUE(found->cause == Cause::rig_inverted || found->cause == Cause::rig_exchanged)
        << name_of(found->cause) << found->detail;
    EXPECT_THAT(found->detail, testing::HasSubstr("the other way round"));
    for (std::size_t k = 1; k < truth.size(); ++k) {
      const Rigid3 link = found->rig_from_cam[0].inverse() * found->rig_from_cam[k];
      const Rigid3 right = truth[0].inverse() * truth[k];
      EXPECT_LT(link.minus(right).norm(), 0.01);
    }
  });
}

TEST(RigHypotheses, ExchangedCamerasAreNamedInPairs) {
  for_rigs([](const SimulatedDrive& drive, const Extrinsics& truth,
              const Extrinsics& calibrated_rig, unsigned seed) {
    if (truth.size() < 3) return;  // of two, the same as an inverted chain
    const std::size_t first = seed % truth.size();
    const std::size_t second = (first + 1) % truth.size();
    Extrinsics stated = calibrated_rig;
    std::swap(stated[first], stated[second]);
    const auto found = explain_rig(drive_tracks(drive, truth), rig_of(stated));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->cause, Cause::rig_exchanged) << found->detail;
    EXPECT_EQ(found->cameras,
              (std::vector<std::size_t>{std::min(first, second), std::max(first, second)}));
  });
}

TEST(RigHypotheses, ACameraStatedTurnedAboutItsAxisIsNamed) {
  for (const int angle : {90, 180, 270}) {
    for_rigs([&](const SimulatedDrive& drive, const Extrinsics& truth,
                 const Extrinsics& calibrated_rig, unsigned seed) {
      const std::size_t k = truth.size() == 2 ? 1 : seed % truth.size();
      Extrinsics stated = calibrated_rig;
      stated[k] = stated[k] * turned_by(-angle, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero());
      const auto found = explain_rig(drive_tracks(drive, truth), rig_of(stated));
      ASSERT_TRUE(found);
      EXPECT_EQ(found->cause, Cause::rig_turned) << found->detail;
      EXPECT_EQ(found->cameras, std::vector<std::size_t>{k}) << found->detail;
    });
  }
}

TEST(RigHypotheses, ImagesThatAreAllTurnedAreNotACamerasFault) {
  for_rigs([](const SimulatedDrive& drive, const Extrinsics& truth,
              const Extrinsics& calibrated_rig, unsigned) {
    Extrinsics stated = calibrated_rig;
    for (Rigid3& x : stated)
      x = x * turned_by(180, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero());
    const auto found = explain_rig(drive_tracks(drive, truth), rig_of(stated));
    ASSERT_TRUE(found);
    // On rigs that are alike in a mirror, an inverted chain is the same.
    EXPECT_TRUE(found->cause == Cause::images_turned || found->cause == Cause::rig_inverted)
        << found->detail;
  });
}

/// The rig with principal points of its own for each camera.
Rig with_own_lenses(Rig rig) {
  for (std::size_t k = 0; k < rig.cameras.size(); ++k) {
    CameraParameters p = rig.cameras[k].model.parameters();
    p.pu_px += 9.0 * static_cast<double>(k) - 6.0;
    p.pv_px -= 7.0 * static_cast<double>(k);
    rig.cameras[k].model = *CameraModel::create(p);
  }
  return rig;
}

/// How places look that are told by another lens: turned by what the principal points differ.
Rigid3 seen_through(const CameraModel& assumed, const CameraModel& actual, bool turned) {
  const CameraParameters& a = assumed.parameters();
  const CameraParameters& b = actual.parameters();
  const Eigen::Vector2d centre(0.5 * (a.width_px - 1), 0.5 * (a.height_px - 1));
  const Eigen::Vector2d b_at = Eigen::Vector2d(b.pu_px, b.pv_px) - centre;
  const Eigen::Vector2d there = turned ? Eigen::Vector2d(-b_at) : b_at;
  // The camera's axis, seen through the assumed lens.
  const Eigen::Vector3d axis = *assumed.bearing(centre + there);
  const Eigen::Quaterniond to_axis =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis);
  const double angle = turned ? std::numbers::pi : 0.0;
  return {(to_axis * Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())).inverse(),
          Eigen::Vector3d::Zero()};
}

TEST(RigHypotheses, ExchangedCamerasHaveExchangedLenses) {
  for_rigs([](const SimulatedDrive& drive, const Extrinsics& truth,
              const Extrinsics& calibrated_rig, unsigned seed) {
    const Rig rig = with_own_lenses(rig_of(calibrated_rig));
    const std::size_t first = seed % truth.size();
    const std::size_t second = (first + 1) % truth.size();
    const auto seen = [&](std::size_t assumed, std::size_t actual) {
      return truth[actual] *
             seen_through(rig.cameras[assumed].model, rig.cameras[actual].model, false);
    };
    Extrinsics apparent = truth;
    apparent[first] = seen(first, second);
    apparent[second] = seen(second, first);
    const auto found = explain_rig(drive_tracks(drive, apparent), rig);
    ASSERT_TRUE(found);
    // Of two cameras an exchange is an inverted chain as well.
    if (truth.size() == 2) {
      EXPECT_TRUE(found->cause == Cause::rig_exchanged || found->cause == Cause::rig_inverted);
      return;
    }
    EXPECT_EQ(found->cause, Cause::rig_exchanged) << found->detail;
    EXPECT_TRUE(found->exchanges_lenses);
    EXPECT_EQ(found->cameras,
              (std::vector<std::size_t>{std::min(first, second), std::max(first, second)}));
  });
}

TEST(RigHypotheses, TransformsExchangedInTheFileLeaveLensesWhereTheyAre) {
  for_rigs([](const SimulatedDrive& drive, const Extrinsics& truth,
              const Extrinsics& calibrated_rig, unsigned seed) {
    if (truth.size() < 3) return;  // of two, the same as an inverted chain
    const std::size_t first = seed % truth.size();
    const std::size_t second = (first + 1) % truth.size();
    Extrinsics stated = calibrated_rig;
    std::swap(stated[first], stated[second]);
    CameraTracks tracks = drive_tracks(drive, truth);
    const Rig rig = with_own_lenses(rig_of(stated));
    for (const RigCamera& camera : rig.cameras) tracks.lenses.push_back(camera.model);
    const auto found = explain_rig(tracks, rig);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->cause, Cause::rig_exchanged) << found->detail;
    EXPECT_FALSE(found->exchanges_lenses);
    EXPECT_EQ(found->cameras,
              (std::vector<std::size_t>{std::min(first, second), std::max(first, second)}));
  });
}

TEST(RigHypotheses, ImagesTurnedInTheDriverTurnThePrincipalPoint) {
  for_rigs([](const SimulatedDrive& drive, const Extrinsics& truth,
              const Extrinsics& calibrated_rig, unsigned) {
    const Rig rig = with_own_lenses(rig_of(calibrated_rig));
    Extrinsics apparent = truth;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      apparent[k] = truth[k] * seen_through(rig.cameras[k].model, rig.cameras[k].model, true);
    }
    const auto found = explain_rig(drive_tracks(drive, apparent), rig);
    ASSERT_TRUE(found);
    // On rigs that are alike in a mirror, an inverted chain is the same.
    EXPECT_TRUE(found->cause == Cause::images_turned || found->cause == Cause::rig_inverted)
        << found->detail;
    EXPECT_EQ(found->turns_lenses, found->cause == Cause::images_turned);
  });
}

TEST(RigHypotheses, TranslationsInAnotherUnitAreToldWithTheUnit) {
  const std::pair<double, const char*> units[] = {
      {1000, "mm"}, {100, "cm"}, {39.3701, "inches"}, {3.28084, "feet"}};
  for (const auto& [factor, name] : units) {
    for_rigs([&](const SimulatedDrive& drive, const Extrinsics& truth,
                 const Extrinsics& calibrated_rig, unsigned) {
      Extrinsics stated = calibrated_rig;
      for (Rigid3& x : stated) x.translation *= factor;
      const auto found = explain_rig(drive_tracks(drive, truth), rig_of(stated));
      ASSERT_TRUE(found);
      EXPECT_EQ(found->cause, Cause::rig_unit) << found->detail;
      EXPECT_THAT(found->detail, testing::HasSubstr(name));
    });
  }
}

TEST(RigHypotheses, SizesThatContradictBaselinesAreToldWithTheFactor) {
  for (const double percent : {-25.0, -20.0, 12.0, 25.0}) {
    for_rigs([&](const SimulatedDrive& drive, const Extrinsics& truth,
                 const Extrinsics& calibrated_rig, unsigned) {
      // Sizes stated too small make a small world: all places shrink.
      CameraTracks tracks = drive_tracks(drive, truth);
      const double factor = 1.0 + percent / 100.0;
      for (auto& instant : tracks.instants) {
        for (auto& place : instant.places) {
          if (place) place->world_from_cam.translation *= factor;
        }
      }
      const auto found = explain_rig(tracks, rig_of(calibrated_rig));
      ASSERT_TRUE(found);
      EXPECT_EQ(found->cause, Cause::size_scale) << found->detail;
      EXPECT_NEAR(found->value, percent, 4 * found->sigma + 0.3);
    });
  }
}

TEST(RigHypotheses, ALateCameraIsToldWithItsDelay) {
  for (const double late_ms : {-60.0, 11.0, 25.0, 100.6, 180.0}) {
    for_rigs([&](const SimulatedDrive& drive, const Extrinsics& truth, const Extrinsics& stated,
                 unsigned seed) {
      const std::size_t k = truth.size() == 2 ? 1 : seed % truth.size();
      const auto found = explain_rig(
          drive_tracks(drive, truth, static_cast<int>(k), 1e-3 * late_ms), rig_of(stated));
      ASSERT_TRUE(found);
      EXPECT_EQ(found->cause, Cause::clock) << found->detail;
      EXPECT_EQ(found->cameras, std::vector<std::size_t>{k}) << found->detail;
      EXPECT_NEAR(found->value, late_ms, 4 * found->sigma + 0.05 * std::abs(late_ms))
          << found->detail;
    });
  }
}

TEST(RigHypotheses, AFrameLostOnTheWayIsToldWithItsMoment) {
  for (const int shift : {1, -1, 2}) {
    for_rigs([&](const SimulatedDrive& drive, const Extrinsics& truth, const Extrinsics& stated,
                 unsigned seed) {
      const std::size_t k = truth.size() == 2 ? 1 : seed % truth.size();
      CameraTracks tracks = drive_tracks(drive, truth);
      const CameraTracks right = tracks;
      const std::size_t from = 18 + seed;
      for (std::size_t i = from; i < tracks.instants.size(); ++i) {
        const std::ptrdiff_t source = static_cast<std::ptrdiff_t>(i) + shift;
        auto& place = tracks.instants[i].places[k];
        place.reset();
        if (source < static_cast<std::ptrdiff_t>(right.instants.size())) {
          place = right.instants[static_cast<std::size_t>(source)].places[k];
        }
      }
      const auto found = explain_rig(tracks, rig_of(stated));
      ASSERT_TRUE(found);
      EXPECT_EQ(found->cause, Cause::frame_order) << found->detail;
      EXPECT_EQ(found->cameras, std::vector<std::size_t>{k}) << found->detail;
      ASSERT_TRUE(found->since);
      const double off_s =
          std::chrono::duration<double>(*found->since - tracks.instants[from].stamp).count();
      EXPECT_LT(std::abs(off_s), 0.65) << found->detail;  // some sets lack a camera
    });
  }
}

TEST(RigHypotheses, ACameraBumpedOnTheWayIsToldWithItsMoment) {
  for (const double angle : {1.0, -2.0, 5.0}) {
    for_rigs([&](const SimulatedDrive& drive, const Extrinsics& truth, const Extrinsics& stated,
                 unsigned seed) {
      const std::size_t k = truth.size() == 2 ? 1 : seed % truth.size();
      const std::size_t from = 18 + 4 * seed;
      CameraTracks tracks = drive_tracks(drive, truth);
      Extrinsics bumped = truth;
      bumped[k] = bumped[k] *
                  turned_by(angle, Eigen::Vector3d(0.3, 1, 0.2), Eigen::Vector3d(0.004, 0, 0.002));
      const CameraTracks after = drive_tracks(drive, bumped);
      for (std::size_t i = from; i < tracks.instants.size(); ++i)
        tracks.instants[i] = after.instants[i];
      const auto found = explain_rig(tracks, rig_of(stated));
      ASSERT_TRUE(found);
      EXPECT_EQ(found->cause, Cause::rig_bumped) << found->detail;
      EXPECT_EQ(found->cameras, std::vector<std::size_t>{k}) << found->detail;
      EXPECT_NEAR(found->value, std::abs(angle), 0.3) << found->detail;
      ASSERT_TRUE(found->since);
      const double off_s =
          std::chrono::duration<double>(*found->since - tracks.instants[from].stamp).count();
      EXPECT_LT(std::abs(off_s), 0.65) << found->detail;  // some sets lack a camera
    });
  }
}

TEST(RigHypotheses, ACameraThatStandsElsewhereThroughoutIsDisplaced) {
  for_rigs([](const SimulatedDrive& drive, const Extrinsics& truth,
              const Extrinsics& calibrated_rig, unsigned seed) {
    const std::size_t k = truth.size() == 2 ? 1 : seed % truth.size();
    Extrinsics stated = calibrated_rig;
    stated[k] =
        stated[k] * turned_by(2.0, Eigen::Vector3d(1, 0.4, 0), Eigen::Vector3d(0.03, 0.01, 0));
    const auto found = explain_rig(drive_tracks(drive, truth), rig_of(stated));
    ASSERT_TRUE(found);
    EXPECT_EQ(found->cause, Cause::rig_displaced) << found->detail;
    EXPECT_EQ(found->cameras, std::vector<std::size_t>{k}) << found->detail;
    EXPECT_NEAR(found->value, 0.0316, 0.003);  // of (30, 10, 0) mm
  });
}

TEST(RigHypotheses, NothingIsSaidOfTooLittle) {
  SimulatedDrive drive;
  drive.instants = 2;
  Extrinsics stated = ring_of_cameras(3, 60);
  std::swap(stated[1], stated[2]);
  EXPECT_FALSE(explain_rig(drive_tracks(drive, ring_of_cameras(3, 60)), rig_of(stated)));
  EXPECT_FALSE(explain_rig(CameraTracks{}, rig_of(stated)));
}

}  // namespace
}  // namespace waymark
