// Hears locd's poses, status and alerts on LCM and appends each to a file, a JSON object per line:
// what the tests outside the virtual machine read. Usage: listener LCM_URL FILE
#include <poll.h>

#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <nlohmann/json.hpp>
#include <waymark/alert_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/status_t.hpp>

#include "drivers/monotonic_clock.h"

namespace {

using nlohmann::json;

json fields(const waymark::pose_t& m) {
  return {{"utime", m.utime},
          {"utime_published", m.utime_published},
          {"seq", m.seq},
          {"session", m.session_id},
          {"position", m.position},
          {"quaternion", m.quaternion},
          {"status", m.status},
          {"reasons", m.reasons},
          {"cameras", m.cameras},
          {"cameras_used", m.cameras_used},
          {"markers_used", m.markers_used},
          {"max_skew_us", m.max_skew_us},
          {"map_hash", m.map_hash},
          {"latency_ms", m.latency_ms}};
}

json fields(const waymark::status_t& m) {
  json cameras = json::array();
  for (const auto& c : m.cameras) {
    cameras.push_back({{"name", c.name},
                       {"state", c.state},
                       {"usable", static_cast<bool>(c.usable)},
                       {"frames", c.frames},
                       {"dropped", c.dropped},
                       {"starts", c.starts},
                       {"error", c.error}});
  }
  json drops = json::object();
  for (std::size_t i = 0; i < m.drops.size(); ++i) drops[m.drop_reason[i]] = m.drops[i];
  return {{"utime", m.utime},
          {"seq", m.seq},
          {"session", m.session_id},
          {"uptime_s", m.uptime_s},
          {"text", m.text},
          {"map_hash", m.map_hash},
          {"cameras", cameras},
          {"sets", m.sets},
          {"poses", m.poses},
          {"drops", drops},
          {"publish_failures", m.publish_failures},
          {"time_status", m.time_status},
          {"time_steps", m.time_steps},
          {"time_error_s", m.time_error_s},
          {"recording", static_cast<bool>(m.recording)},
          {"recording_path", m.recording_path},
          {"recorded_sets", m.recorded_sets},
          {"recorded_bytes", m.recorded_bytes},
          {"recorder_drops", m.recorder_drops},
          {"reload_refused", m.reload_refused}};
}

json fields(const waymark::alert_t& m) {
  return {{"seq", m.seq},   {"session", m.session_id}, {"raised", static_cast<bool>(m.raised)},
          {"kind", m.kind}, {"subject", m.subject},    {"text", m.text}};
}

class Notebook {
 public:
  explicit Notebook(const char* path) : file_(path, std::ios::app) {}

  template <typename Message>
  void write(const lcm::ReceiveBuffer*, const std::string& channel, const Message* message) {
    json line = fields(*message);
    line["channel"] = channel;
    // CLOCK_MONOTONIC of the machine that this runs on, s.
    line["heard_s"] = std::chrono::duration<double>(waymark::monotonic_now()).count();
    file_ << line.dump() << std::endl;
  }
  [[nodiscard]] bool good() const { return file_.good(); }

 private:
  std::ofstream file_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 64;
  lcm::LCM lcm(argv[1]);
  Notebook notebook(argv[2]);
  if (!lcm.good() || !notebook.good()) return 69;
  lcm.subscribe("WAYMARK_POSE", &Notebook::write<waymark::pose_t>, &notebook);
  lcm.subscribe("WAYMARK_STATUS", &Notebook::write<waymark::status_t>, &notebook);
  lcm.subscribe("WAYMARK_ALERT", &Notebook::write<waymark::alert_t>, &notebook);
  while (lcm.handle() == 0) {
  }
  return 74;
}
