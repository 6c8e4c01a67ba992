#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <array>
#include <atomic>
#include <cstring>
#include <string>
#include <thread>

#include "core/base/descriptor.h"
#include "tests/support/temporary_folder.h"

namespace waymark::test {

/// A socket that answers the first request with what a test says, and then closes; silent while
/// that is empty.
class FakeLocd {
 public:
  explicit FakeLocd(std::string answer)
      : listener_(::socket(AF_UNIX, SOCK_STREAM, 0)), answer_(std::move(answer)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path().c_str(), sizeof address.sun_path - 1);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
    EXPECT_EQ(::bind(listener_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(listener_.get(), 1), 0);
    thread_ = std::thread([this] { serve(); });
  }
  FakeLocd(const FakeLocd&) = delete;
  FakeLocd& operator=(const FakeLocd&) = delete;
  ~FakeLocd() {
    ending_ = true;
    thread_.join();
  }

  [[nodiscard]] std::filesystem::path path() const { return folder_.path() / "control"; }
  /// What was asked; known once an answer has come.
  [[nodiscard]] const std::string& asked() const { return asked_; }

 private:
  void serve() {
    if (!wait(listener_)) return;
    const Descriptor client(::accept(listener_.get(), nullptr, nullptr));
    std::array<char, 1024> buffer{};
    if (!wait(client)) return;
    const ssize_t got = ::recv(client.get(), buffer.data(), buffer.size(), 0);
    asked_.assign(buffer.data(), got > 0 ? static_cast<std::size_t>(got) : 0);
    while (answer_.empty() && !ending_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    (void)::send(client.get(), answer_.data(), answer_.size(), MSG_NOSIGNAL);
  }
  [[nodiscard]] bool wait(const Descriptor& descriptor) const {
    while (!ending_) {
      pollfd readable{descriptor.get(), POLLIN, 0};
      if (::poll(&readable, 1, 10) > 0) return true;
    }
    return false;
  }

  TemporaryFolder folder_;
  Descriptor listener_;
  std::string answer_;
  std::string asked_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace waymark::test
