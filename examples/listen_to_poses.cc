// Prints poses as locd publishes them. Usage: listen_to_poses LCM_URL COUNT
#include <cstdio>
#include <cstdlib>
#include <lcm/lcm-cpp.hpp>
#include <waymark/pose_t.hpp>

namespace {

struct Listener {
  int left;

  void handle(const lcm::ReceiveBuffer*, const std::string&, const waymark::pose_t* pose) {
    // Only OK is to be relied upon.
    std::printf("%s %lld: %.3f %.3f %.3f m\n",
                pose->status == waymark::pose_t::OK ? "OK" : "not OK",
                static_cast<long long>(pose->utime), pose->position[0], pose->position[1],
                pose->position[2]);
    std::fflush(stdout);
    --left;
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: listen_to_poses LCM_URL COUNT\n", stderr);
    return 64;
  }
  lcm::LCM lcm(argv[1]);
  if (!lcm.good()) {
    std::fprintf(stderr, "listen_to_poses: LCM does not open %s\n", argv[1]);
    return 69;
  }
  Listener listener{std::atoi(argv[2])};
  lcm.subscribe("WAYMARK_POSE", &Listener::handle, &listener);
  std::puts("listening");
  std::fflush(stdout);
  while (listener.left > 0 && lcm.handle() == 0) {
  }
  return listener.left > 0 ? 74 : 0;
}
