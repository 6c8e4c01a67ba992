#include <algorithm>
#include <cmath>
#include <regex>

#include "bench/cause_variants/faults.h"

namespace waymark::bench {
namespace {

using simulator::Random;

/// False where no lens has such numbers: the reader of rig.yaml would refuse them.
template <typename Change>
[[nodiscard]] bool change_lens(RigCamera& camera, const Change& change) {
  CameraParameters p = camera.model.parameters();
  change(p);
  auto model = CameraModel::create(p);
  if (!model) return false;
  camera.model = *std::move(model);
  return true;
}

/// All cameras or one of them, as drawn.
std::vector<std::size_t> some_or_all(const World& world, Random& random) {
  if (random.uniform() < 0.5) return {static_cast<std::size_t>(random.below(world.cameras()))};
  std::vector<std::size_t> all;
  for (std::size_t k = 0; k < world.cameras(); ++k) all.push_back(k);
  return all;
}

void blame(Variant& variant, const std::vector<std::size_t>& cameras, std::set<Cause> causes) {
  variant.truth.causes = std::move(causes);
  for (const std::size_t k : cameras) {
    variant.truth.cameras.insert(variant.world().rig.cameras[k].name);
  }
  variant.truth.exits = {65};
}

bool focal_length(Variant& variant, Random& random) {
  World& world = variant.world();
  const auto cameras = some_or_all(world, random);
  const double factor = 1 + either_sign(0.05, 0.4, random);
  for (const std::size_t k : cameras) {
    if (!change_lens(world.stated_rig.cameras[k], [&](CameraParameters& p) {
          p.fu_px *= factor;
          p.fv_px *= factor;
        }))
      return false;
  }
  // By a simple factor it is that of another resolution as likely.
  blame(variant, cameras, {Cause::intrinsics, Cause::resolution});
  variant.truth.value = 100 * (1 / factor - 1);
  variant.truth.within = 1.5;
  return true;
}

bool distortion_unstated(Variant& variant, Random& random) {
  World& world = variant.world();
  const auto cameras = some_or_all(world, random);
  for (const std::size_t k : cameras) {
    if (!change_lens(world.stated_rig.cameras[k], [](CameraParameters& p) {
          p.distortion = Distortion::none;
          p.coefficients = {};
        }))
      return false;
  }
  blame(variant, cameras, {Cause::intrinsics});
  // Where what is seen bends little the map stands.
  variant.truth.exits = {0, 65};
  return true;
}

/// In the text, for numbers that no camera has are refused as they are read.
bool another_order(Variant& variant, Random& random) {
  const auto cameras = some_or_all(variant.world(), random);
  variant.on_rig = [cameras](std::string& text) {
    static const std::regex kIntrinsics(R"(intrinsics: \[([^,]*), ([^,]*), ([^,]*), ([^\]]*)\])");
    std::string changed;
    std::size_t camera = 0;
    auto rest = text.cbegin();
    for (std::smatch match; std::regex_search(rest, text.cend(), match, kIntrinsics); ++camera) {
      const bool hit = std::find(cameras.begin(), cameras.end(), camera) != cameras.end();
      changed += match.prefix();
      changed += match.format(hit ? "intrinsics: [$3, $4, $1, $2]" : "$&");
      rest = match.suffix().first;
    }
    text = changed.append(rest, text.cend());
  };
  blame(variant, cameras, {Cause::intrinsics});
  return true;
}

bool lenses_exchanged(Variant& variant, Random& random) {
  World& world = variant.world();
  const std::size_t a = random.below(world.cameras());
  const std::size_t b = (a + 1 + random.below(world.cameras() - 1)) % world.cameras();
  std::swap(world.stated_rig.cameras[a].model, world.stated_rig.cameras[b].model);
  blame(variant, {a, b}, {Cause::intrinsics, Cause::crop});
  variant.truth.exits = {0, 65};
  return true;
}

bool resolution(Variant& variant, Random& random) {
  constexpr double kFactors[] = {0.5, 2.0, 0.75, 1.5};
  World& world = variant.world();
  const auto cameras = some_or_all(world, random);
  const double factor = kFactors[random.below(4)];
  for (const std::size_t k : cameras) {
    if (!change_lens(world.stated_rig.cameras[k], [&](CameraParameters& p) {
          p.fu_px *= factor;
          p.fv_px *= factor;
          p.pu_px = (p.pu_px + 0.5) * factor - 0.5;
          p.pv_px = (p.pv_px + 0.5) * factor - 0.5;
          p.width_px = static_cast<int>(std::lround(p.width_px * factor));
          p.height_px = static_cast<int>(std::lround(p.height_px * factor));
        }))
      return false;
  }
  blame(variant, cameras, {Cause::resolution});
  variant.truth.value = 100 * (1 / factor - 1);
  variant.truth.within = 3;
  return true;
}

bool squeezed(Variant& variant, Random& random) {
  World& world = variant.world();
  const auto cameras = some_or_all(world, random);
  const double factor = random.uniform() < 0.5 ? 0.75 : 4.0 / 3.0;
  for (const std::size_t k : cameras) {
    if (!change_lens(world.stated_rig.cameras[k], [&](CameraParameters& p) {
          p.fv_px *= factor;
          p.pv_px = (p.pv_px + 0.5) * factor - 0.5;
          p.height_px = static_cast<int>(std::lround(p.height_px * factor));
        }))
      return false;
  }
  blame(variant, cameras, {Cause::resolution});
  return true;
}

/// The stated calibration is of a larger image, of which a part was recorded.
bool cropped(Variant& variant, Random& random) {
  World& world = variant.world();
  const auto cameras = some_or_all(world, random);
  const double left = random.uniform(0.05, 0.2);
  const double top = random.uniform(0.05, 0.2);
  for (const std::size_t k : cameras) {
    if (!change_lens(world.stated_rig.cameras[k], [&](CameraParameters& p) {
          const double dx_px = std::round(left * p.width_px);
          const double dy_px = std::round(top * p.height_px);
          p.pu_px += dx_px;
          p.pv_px += dy_px;
          p.width_px += static_cast<int>(dx_px) + static_cast<int>(random.below(200));
          p.height_px += static_cast<int>(dy_px) + static_cast<int>(random.below(200));
          if (k == cameras.front()) variant.truth.value = std::hypot(dx_px, dy_px);
        }))
      return false;
  }
  blame(variant, cameras, {Cause::crop});
  variant.truth.within = 20;
  return true;
}

/// The driver rectifies; stated is the raw lens.
bool rectified(Variant& variant, Random& random) {
  World& world = variant.world();
  const auto cameras = some_or_all(world, random);
  for (const std::size_t k : cameras) {
    if (!change_lens(world.rig.cameras[k], [](CameraParameters& p) {
          p.distortion = Distortion::none;
          p.coefficients = {};
        }))
      return false;
    if (world.kind == RigKind::fisheye) continue;
    if (!change_lens(world.stated_rig.cameras[k], [&](CameraParameters& p) {
          p.distortion = Distortion::radtan;
          p.coefficients = {either_sign(0.1, 0.3, random), 0.03, 0, 0};
        }))
      return false;
  }
  blame(variant, cameras, {Cause::rectified});
  variant.truth.exits = {0, 65};
  return true;
}

/// The driver turns all images by 180°.
bool all_turned(Variant& variant, Random&) {
  const World& world = variant.world();
  std::vector<Eigen::Vector2d> far_px;
  for (const RigCamera& camera : world.rig.cameras) {
    const CameraParameters& p = camera.model.parameters();
    far_px.emplace_back(p.width_px - 1, p.height_px - 1);
    // One camera alone tells by its principal point only.
    constexpr double kTells_px = 8;
    const Eigen::Vector2d off = Eigen::Vector2d(p.pu_px, p.pv_px) - 0.5 * far_px.back();
    if (world.cameras() == 1 && off.norm() < kTells_px) return false;
  }
  variant.on_images.emplace_back([far_px](std::vector<ImageDetections>& images) {
    for (ImageDetections& image : images) {
      for (Detection& detection : image.detections) {
        for (Eigen::Vector2d& corner : detection.corners) {
          corner = far_px[static_cast<std::size_t>(image.camera)] - corner;
        }
      }
    }
  });
  variant.truth.causes = {Cause::images_turned};
  // Two cameras turned are two that change places and look the other way up.
  if (world.cameras() == 2) {
    variant.truth.causes.insert({Cause::rig_inverted, Cause::rig_exchanged});
  }
  variant.truth.cameras = every_camera(world);
  variant.truth.exits = {65};
  return true;
}

constexpr Fault kFaults[] = {
    {Cause::intrinsics, "focal length off by 5 to 40 %", 1, false, focal_length},
    {Cause::intrinsics, "distortion unstated", 1, false, distortion_unstated},
    {Cause::intrinsics, "written as cx cy fx fy", 1, false, another_order},
    {Cause::intrinsics, "lenses of two cameras exchanged", 2, false, lenses_exchanged},
    {Cause::resolution, "calibrated at another resolution", 1, false, resolution},
    {Cause::resolution, "images scaled in one direction", 1, false, squeezed},
    {Cause::crop, "images cropped", 1, false, cropped},
    {Cause::rectified, "images rectified, raw lens stated", 1, false, rectified},
    {Cause::images_turned, "all images turned by 180 degrees", 1, false, all_turned},
};

}  // namespace

std::span<const Fault> lens_faults() { return kFaults; }

}  // namespace waymark::bench
