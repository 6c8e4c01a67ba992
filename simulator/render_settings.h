#pragma once

#include <cstdint>

namespace waymark::simulator {

/// How a pixel's collected light becomes a grey level.
enum class Response { linear, srgb };

/// Everything that makes an image hard, each with its unit. Defaults are the level `still`.
struct RenderSettings {
  // Surfaces and light.
  double white_albedo = 0.86;  ///< of a marker's paper, 0…1
  double black_albedo = 0.05;  ///< of a marker's ink, 0…1
  double texture_contrast =
      0.22;                    ///< of walls: standard deviation of albedo / albedo; 0 = plain walls
  bool uniform_light = false;  ///< irradiance 1 everywhere: no lamps, no shadows (for tests)

  // Optics.
  double psf_sigma_px = 0.7;  ///< Gaussian of the lens alone, before the pixel collects; ≥ 0.3
  double defocus_sigma_px = 0.0;  ///< added in quadrature
  double vignetting =
      0.35;  ///< share of light lost in the farthest image corner, falling with r²; 0…1

  // Motion.
  double exposure_s = 0.0;  ///< 0: frozen
  double readout_s = 0.0;   ///< first to last row; 0: global shutter
  int sub_exposures = 12;   ///< over which motion is averaged, at most

  // Sensor.
  double white_level = 205;    ///< grey level of white paper at irradiance 1 in the image's centre;
                               ///< light above 255 saturates
  double full_well_e = 10000;  ///< electrons at level 255; shot noise follows from it
  double read_noise_e = 12;    ///< electrons, per pixel
  bool noise = true;
  Response response = Response::linear;

  // Sampling: sub-pixels per pixel, along one axis, where markers or edges of surfaces lie.
  int oversampling = 2;

  // File.
  bool png = false;  ///< else JPEG
  int jpeg_quality = 95;

  // Rig.
  double stamp_skew_sigma_s =
      0.0;  ///< by which each camera's exposure, and its stamp with it, is off the set's
};

/// Standing, global shutter: what the paper's tables are measured on.
[[nodiscard]] inline RenderSettings still_level() { return {}; }

/// Driving: 4 ms exposure, 12 ms read-out, cameras triggered by software with a jitter of 0.7 ms.
[[nodiscard]] inline RenderSettings drive_level() {
  RenderSettings settings;
  settings.exposure_s = 0.004;
  settings.readout_s = 0.012;
  settings.stamp_skew_sigma_s = 0.0007;
  return settings;
}

}  // namespace waymark::simulator
