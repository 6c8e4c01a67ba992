// Prints the poses of one vehicle, and none that anybody else has made.
//
// Usage: verified_poses KEY_FILE [COUNT] [URL [CHANNEL]]
//
// Four things make a pose one to be believed: its code fits (made with the key), its number is
// above the last one's (not played again), its session is that of the first (another one needs a
// look at its age, too), and it is young.
#include <sodium.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <waymark/pose_t.hpp>
#include <waymark/signed_pose_t.hpp>

namespace {

using Key = std::array<unsigned char, crypto_auth_hmacsha256_KEYBYTES>;

bool read_key(const char* file, Key& key) {
  std::string digits;
  std::ifstream(file) >> digits;
  std::size_t length = 0;
  return sodium_hex2bin(key.data(), key.size(), digits.data(), digits.size(), nullptr, &length,
                        nullptr) == 0 &&
         length == key.size();
}

bool is_genuine(const Key& key, const std::string& channel, const waymark::signed_pose_t& message) {
  std::array<unsigned char, 8> seq{};
  for (std::size_t i = 0; i < seq.size(); ++i) {
    seq[i] = static_cast<unsigned char>(static_cast<std::uint64_t>(message.seq) >> (56 - 8 * i));
  }
  crypto_auth_hmacsha256_state state;
  crypto_auth_hmacsha256_init(&state, key.data(), key.size());
  // With the zero at its end.
  crypto_auth_hmacsha256_update(&state, reinterpret_cast<const unsigned char*>(channel.c_str()),
                                channel.size() + 1);
  crypto_auth_hmacsha256_update(&state, seq.data(), seq.size());
  crypto_auth_hmacsha256_update(&state, message.pose.data(), message.pose.size());
  std::array<unsigned char, crypto_auth_hmacsha256_BYTES> mac{};
  crypto_auth_hmacsha256_final(&state, mac.data());
  // Takes as long whatever differs, so that nobody finds a code byte by byte.
  return sodium_memcmp(mac.data(), message.mac, sizeof message.mac) == 0;
}

class Listener {
 public:
  Listener(const Key& key, int count) : key_(key), left_(count) {}

  void hear(const lcm::ReceiveBuffer* /*buffer*/, const std::string& channel,
            const waymark::signed_pose_t* message) {
    waymark::pose_t pose;
    if (!is_genuine(key_, channel, *message)) return turn_away("forged");
    if (pose.decode(message->pose.data(), 0, message->size) != message->size) {
      return turn_away("of another version");
    }
    if (pose.session_id == session_ && message->seq <= seq_) return turn_away("played again");
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const double age_s =
        static_cast<double>(std::chrono::duration_cast<std::chrono::microseconds>(now).count() -
                            pose.utime_published) *
        1e-6;
    // Whoever kept an earlier session's poses can play those; only their age tells.
    if (age_s > 1.0 || age_s < -1.0) return turn_away("not of now");
    session_ = pose.session_id;
    seq_ = message->seq;
    std::printf("pose %lld: status %d, %.3f %.3f %.3f m\n", static_cast<long long>(pose.seq),
                pose.status, pose.position[0], pose.position[1], pose.position[2]);
    std::fflush(stdout);
    --left_;
  }
  bool wants_more() const { return left_ != 0; }

 private:
  void turn_away(const char* why) {
    std::printf("not believed: %s\n", why);
    std::fflush(stdout);
    --left_;
  }

  Key key_;
  int left_;
  std::string session_;
  std::int64_t seq_ = -1;
};

}  // namespace

int main(int argc, char** argv) {
  Key key{};
  if (argc < 2 || sodium_init() < 0 || !read_key(argv[1], key)) {
    std::fputs("usage: verified_poses KEY_FILE [COUNT] [URL [CHANNEL]]\n", stderr);
    return 64;
  }
  Listener listener(key, argc > 2 ? std::atoi(argv[2]) : -1);
  lcm::LCM lcm(argc > 3 ? argv[3] : "udpm://239.255.76.67:7667?ttl=0");
  if (!lcm.good()) return 69;
  lcm.subscribe(argc > 4 ? argv[4] : "WAYMARK_SIGNED_POSE", &Listener::hear, &listener);
  std::puts("listening");
  std::fflush(stdout);
  while (listener.wants_more() && lcm.handle() == 0) continue;
  return listener.wants_more() ? 74 : 0;
}
