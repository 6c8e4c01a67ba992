#include <waymark/alert_t.hpp>
#include <waymark/pose_t.hpp>
#include <waymark/status_t.hpp>

int main() {
  waymark::pose_t pose{};
  pose.status = waymark::pose_t::LOST;
  return pose.getEncodedSize() > 0 && pose.status == 3 ? 0 : 1;
}
