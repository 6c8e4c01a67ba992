#include "core/capture/edge_line.h"

#include <fmt/format.h>

#include "core/base/text_field.h"
#include "core/camera/rig.h"

namespace waymark {
namespace {

constexpr std::string_view kMovedKey = " moved_px=";
constexpr std::string_view kBiasKey = " bias_px=";
constexpr std::string_view kSigmaKey = " sigma_px=";
constexpr std::string_view kResponseKey = " response=";
constexpr std::string_view kOpen = "open";

/// `CAMERA moved_px=…` behind the prefix.
std::optional<EdgeLine> parse_stated(std::string_view text, std::size_t moved_at) {
  const auto px = parse_whole<double>(text.substr(moved_at + kMovedKey.size()));
  if (!px || !RigCamera::kEdgeBias_px.contains(*px)) return std::nullopt;
  return EdgeLine{std::string(text.substr(0, moved_at)), {*px, std::nullopt}};
}

/// `CAMERA bias_px=… sigma_px=… response=…` behind the prefix.
std::optional<EdgeLine> parse_measured(std::string_view text) {
  const auto bias_at = text.rfind(kBiasKey);
  const auto sigma_at = text.rfind(kSigmaKey);
  const auto response_at = text.rfind(kResponseKey);
  if (response_at == std::string_view::npos || bias_at > sigma_at || sigma_at > response_at) {
    return std::nullopt;
  }
  const auto between = [&](std::size_t begin, std::size_t end) {
    return text.substr(begin, end - begin);
  };
  const auto bias = parse_whole<double>(between(bias_at + kBiasKey.size(), sigma_at));
  const auto sigma = parse_whole<double>(between(sigma_at + kSigmaKey.size(), response_at));
  const std::string_view response = text.substr(response_at + kResponseKey.size());
  const auto known = sensor_response_from(response);
  if (!bias || !sigma || !RigCamera::kEdgeBias_px.contains(*bias) || !(*sigma > 0) ||
      !(*sigma < RigCamera::kEdgeBias_px.high) || (!known && response != kOpen)) {
    return std::nullopt;
  }
  return EdgeLine{std::string(text.substr(0, bias_at)),
                  {*bias, EdgeMeasurement{*bias, *sigma, known}}};
}

}  // namespace

std::string edge_line(std::string_view camera, const EdgeMove& move) {
  if (!move.measured) return fmt::format("{}{}{}{}", kEdgeLinePrefix, camera, kMovedKey, move.px);
  const EdgeMeasurement& edges = *move.measured;
  return fmt::format("{}{}{}{:.4f}{}{:.3g}{}{}", kEdgeLinePrefix, camera, kBiasKey, edges.bias_px,
                     kSigmaKey, edges.sigma_px, kResponseKey,
                     edges.response ? to_string(*edges.response) : kOpen);
}

std::optional<EdgeLine> parse_edge_line(std::string_view line) {
  if (!line.starts_with(kEdgeLinePrefix)) return std::nullopt;
  const std::string_view text = line.substr(kEdgeLinePrefix.size());
  const auto moved_at = text.rfind(kMovedKey);
  return moved_at == std::string_view::npos ? parse_measured(text) : parse_stated(text, moved_at);
}

}  // namespace waymark
