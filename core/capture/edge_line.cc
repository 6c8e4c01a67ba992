#include "core/capture/edge_line.h"

#include <fmt/format.h>

#include "core/base/text_field.h"
#include "core/camera/rig.h"

namespace waymark {
namespace {

constexpr std::string_view kBiasKey = " bias_px=";
constexpr std::string_view kSigmaKey = " sigma_px=";
constexpr std::string_view kResponseKey = " response=";
constexpr std::string_view kOpen = "open";

}  // namespace

std::string edge_line(std::string_view camera, const EdgeMeasurement& edges) {
  return fmt::format("{}{}{}{:.4f}{}{:.4f}{}{}", kEdgeLinePrefix, camera, kBiasKey, edges.bias_px,
                     kSigmaKey, edges.sigma_px, kResponseKey,
                     edges.response ? to_string(*edges.response) : kOpen);
}

std::optional<EdgeLine> parse_edge_line(std::string_view line) {
  const auto bias_at = line.rfind(kBiasKey);
  const auto sigma_at = line.rfind(kSigmaKey);
  const auto response_at = line.rfind(kResponseKey);
  if (!line.starts_with(kEdgeLinePrefix) || response_at == std::string_view::npos ||
      bias_at < kEdgeLinePrefix.size() || bias_at > sigma_at || sigma_at > response_at) {
    return std::nullopt;
  }
  const auto between = [&](std::size_t begin, std::size_t end) {
    return line.substr(begin, end - begin);
  };
  const auto bias = parse_whole<double>(between(bias_at + kBiasKey.size(), sigma_at));
  const auto sigma = parse_whole<double>(between(sigma_at + kSigmaKey.size(), response_at));
  const std::string_view response = line.substr(response_at + kResponseKey.size());
  const auto known = sensor_response_from(response);
  if (!bias || !sigma || !RigCamera::kEdgeBias_px.contains(*bias) || !(*sigma > 0) ||
      !(*sigma < RigCamera::kEdgeBias_px.high) || (!known && response != kOpen)) {
    return std::nullopt;
  }
  return EdgeLine{std::string(between(kEdgeLinePrefix.size(), bias_at)), {*bias, *sigma, known}};
}

}  // namespace waymark
