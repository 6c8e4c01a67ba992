#include "locd/publish/message_key.h"

#include <sodium.h>
#include <sys/stat.h>

#include <algorithm>

#include "core/base/atomic_file.h"
#include "core/base/text_field.h"

namespace waymark {
namespace {

static_assert(MessageKey::kBytes == crypto_auth_hmacsha256_KEYBYTES);

constexpr std::size_t kMaxFile = 1024;

/// The number as it goes into the mac, the highest byte first.
std::array<std::uint8_t, 8> big_endian(std::int64_t number) {
  std::array<std::uint8_t, 8> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(number) >> (56 - 8 * i));
  }
  return bytes;
}

}  // namespace

Expected<MessageKey> MessageKey::read(const std::filesystem::path& file) {
  const auto text = read_file(file, kMaxFile);
  if (!text) return tl::make_unexpected(text.error());
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0 || (status.st_mode & S_IRWXO) != 0) {
    return fail(ErrorKind::config, "{}: others may read or write the key; chmod o= {}",
                file.string(), file.string());
  }
  std::string_view digits = *text;
  while (!digits.empty() && digits.back() == '\n') digits.remove_suffix(1);
  MessageKey key;
  std::size_t length = 0;
  if (digits.size() != 2 * kBytes ||
      ::sodium_hex2bin(key.bytes_.data(), kBytes, digits.data(), digits.size(), nullptr, &length,
                       nullptr) != 0 ||
      length != kBytes) {
    return fail(ErrorKind::config,
                "{}: a key is {} hexadecimal digits; make one: openssl rand -hex {}", file.string(),
                2 * kBytes, kBytes);
  }
  return key;
}

void MessageKey::sign(std::string_view channel, signed_pose_t& message) const {
  const auto* const name =
      reinterpret_cast<const unsigned char*>(channel.data());  // NOLINT: bytes are bytes
  const std::uint8_t zero = 0;
  const auto seq = big_endian(message.seq);
  crypto_auth_hmacsha256_state state;
  ::crypto_auth_hmacsha256_init(&state, bytes_.data(), bytes_.size());
  ::crypto_auth_hmacsha256_update(&state, name, channel.size());
  ::crypto_auth_hmacsha256_update(&state, &zero, 1);
  ::crypto_auth_hmacsha256_update(&state, seq.data(), seq.size());
  ::crypto_auth_hmacsha256_update(&state, message.pose.data(), message.pose.size());
  std::array<std::uint8_t, crypto_auth_hmacsha256_BYTES> mac{};
  ::crypto_auth_hmacsha256_final(&state, mac.data());
  std::copy_n(mac.begin(), sizeof message.mac, std::begin(message.mac));
}

}  // namespace waymark
