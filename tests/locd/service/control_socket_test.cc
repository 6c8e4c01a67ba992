#include "locd/service/control_socket.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <array>
#include <cstring>
#include <optional>

#include "tests/support/no_descriptors_left.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

class Client {
 public:
  explicit Client(const std::filesystem::path& path) : socket_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast)
    EXPECT_EQ(::connect(socket_.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  }
  void send(std::string_view text) const {
    EXPECT_EQ(::send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
  }
  /// As `echo start | socat - UNIX:…` does.
  void say_nothing_more() const { EXPECT_EQ(::shutdown(socket_.get(), SHUT_WR), 0); }
  /// What has come so far; empty when the other side has closed or sent nothing.
  [[nodiscard]] std::string receive() const {
    std::array<char, 4096> buffer{};
    const ssize_t got = ::recv(socket_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    return {buffer.data(), got > 0 ? static_cast<std::size_t>(got) : 0};
  }

 private:
  Descriptor socket_;
};

constexpr Stamp kNow = std::chrono::seconds(1);

ControlSocket::Answer echo(std::string_view request) {
  return [answer = "ok " + std::string(request)](Stamp /*now*/) { return answer; };
}

/// Answers when a second has passed.
ControlSocket::Answer echo_later(std::string_view request) {
  return [answer = "ok " + std::string(request)](Stamp now) {
    return now < kNow + std::chrono::seconds(1) ? std::nullopt : std::optional(answer);
  };
}

TEST(ControlSocket, AnswersALineWithALine) {
  const TemporaryFolder tmp;
  auto socket = ControlSocket::open(tmp.path() / "control");
  ASSERT_TRUE(socket) << socket.error().message;
  const Client client(tmp.path() / "control");
  client.send("sta");
  socket->serve(echo, kNow);
  EXPECT_EQ(client.receive(), "");
  client.send("rt\r\nstop\n");
  socket->serve(echo, kNow);
  EXPECT_EQ(client.receive(), "ok start\nok stop\n");
}

TEST(ControlSocket, AnAnswerMayTakeItsTimeAndHoldsUpNobodyElse) {
  const TemporaryFolder tmp;
  auto socket = ControlSocket::open(tmp.path() / "control");
  ASSERT_TRUE(socket);
  const Client patient(tmp.path() / "control");
  patient.send("stop\nstart\n");
  socket->serve(echo_later, kNow);
  EXPECT_EQ(patient.receive(), "");
  const Client quick(tmp.path() / "control");
  quick.send("status\n");
  socket->serve(echo, kNow);
  EXPECT_EQ(quick.receive(), "ok status\n");
  EXPECT_EQ(patient.receive(), "");
  socket->serve(echo, kNow + std::chrono::seconds(1));
  EXPECT_EQ(patient.receive(), "ok stop\nok start\n");
}

TEST(ControlSocket, WhoSaysNothingMoreIsStillAnswered) {
  const TemporaryFolder tmp;
  auto socket = ControlSocket::open(tmp.path() / "control");
  ASSERT_TRUE(socket);
  const Client client(tmp.path() / "control");
  client.send("stop\n");
  client.say_nothing_more();
  socket->serve(echo_later, kNow);
  socket->serve(echo_later, kNow);
  EXPECT_EQ(client.receive(), "");
  socket->serve(echo_later, kNow + std::chrono::seconds(1));
  EXPECT_EQ(client.receive(), "ok stop\n");
}

TEST(ControlSocket, IsForOwnerAndGroup) {
  const TemporaryFolder tmp;
  const auto socket = ControlSocket::open(tmp.path() / "control");
  ASSERT_TRUE(socket);
  struct stat status {};
  ASSERT_EQ(::stat((tmp.path() / "control").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0660U);
}

TEST(ControlSocket, TakesThePlaceOfADeadOneAndGoesAtTheEnd) {
  const TemporaryFolder tmp;
  tmp.write("control", "left by a process that was killed");
  {
    auto socket = ControlSocket::open(tmp.path() / "control");
    ASSERT_TRUE(socket);
    const Client client(tmp.path() / "control");
    client.send("x\n");
    socket->serve(echo, kNow);
    EXPECT_EQ(client.receive(), "ok x\n");
  }
  EXPECT_FALSE(std::filesystem::exists(tmp.path() / "control"));
}

TEST(ControlSocket, ALineOfMoreThanARequestsBytesIsNotHandled) {
  const TemporaryFolder tmp;
  auto socket = ControlSocket::open(tmp.path() / "control");
  ASSERT_TRUE(socket);
  const std::string most(ControlSocket::kMaxRequest, 'x');
  const Client client(tmp.path() / "control");
  client.send(most + "\nstop\n");
  socket->serve(echo, kNow);
  EXPECT_EQ(client.receive(), "ok " + most + "\nok stop\n");
  client.send("x" + most + "\nstop\n");
  socket->serve(echo, kNow);
  EXPECT_EQ(client.receive(), "");
}

TEST(ControlSocket, EndlessRequestsAndManyClientsHurtNobody) {
  const TemporaryFolder tmp;
  auto socket = ControlSocket::open(tmp.path() / "control");
  ASSERT_TRUE(socket);
  const Client endless(tmp.path() / "control");
  endless.send(std::string(100'000, 'x'));
  socket->serve(echo, kNow);
  std::vector<std::unique_ptr<Client>> crowd;
  for (int i = 0; i < 20; ++i) {
    crowd.push_back(std::make_unique<Client>(tmp.path() / "control"));
    socket->serve(echo, kNow);
  }
  crowd.back()->send("still there\n");
  socket->serve(echo, kNow);
  EXPECT_EQ(crowd.back()->receive(), "ok still there\n");
}

TEST(ControlSocket, WithoutAnyDescriptorLeftWhoWaitsIsTurnedAwayAndOthersAreServedLater) {
  const TemporaryFolder tmp;
  auto socket = ControlSocket::open(tmp.path() / "control");
  ASSERT_TRUE(socket);
  const auto is_readable = [&] {
    pollfd listener{socket->descriptor(), POLLIN, 0};
    return ::poll(&listener, 1, 0) > 0;
  };
  {
    const Client first(tmp.path() / "control");
    const Client second(tmp.path() / "control");
    const test::NoDescriptorsLeft none;
    ASSERT_TRUE(is_readable());
    for (int turn = 0; turn < 2; ++turn) socket->serve(echo, kNow);
    EXPECT_FALSE(is_readable()) << "the service loop would never wait again";
  }
  const Client later(tmp.path() / "control");
  later.send("start\n");
  socket->serve(echo, kNow);
  EXPECT_EQ(later.receive(), "ok start\n");
}

TEST(ControlSocket, AFolderThatIsNotThereIsSaid) {
  const auto socket = ControlSocket::open("/nonexistent/control");
  ASSERT_FALSE(socket);
  EXPECT_EQ(socket.error().kind, ErrorKind::cant_create);
}

}  // namespace
}  // namespace waymark
