#include "locd/service/service_notifier.h"

#include "tests/locd/service/daemon_fixture.h"

namespace waymark {
namespace {

using test::FakeSystemd;
using testing::Contains;
using testing::ElementsAre;
using testing::SizeIs;

TEST(ServiceNotifier, ReadyIsADatagramOfItsOwn) {
  FakeSystemd systemd;
  ServiceNotifier notifier;
  notifier.ready("all cameras stream");
  EXPECT_THAT(systemd.datagrams(), ElementsAre("STATUS=all cameras stream", "READY=1"));
}

TEST(ServiceNotifier, ReadyIsHeardHoweverLongTheTextIs) {
  FakeSystemd systemd;
  ServiceNotifier notifier;
  notifier.ready("reload refused: " + std::string(200'000, 'k'));
  EXPECT_THAT(systemd.datagrams(), Contains("READY=1"));
  EXPECT_THAT(systemd.datagrams(), SizeIs(2)) << "the text was longer than systemd reads";
}

TEST(ServiceNotifier, ATextGivesNoOrders) {
  FakeSystemd systemd;
  ServiceNotifier notifier;
  notifier.status("cam0: T_x\nWATCHDOG=trigger\nMAINPID=1\x1b[2J");
  EXPECT_THAT(systemd.datagrams(),
              ElementsAre("STATUS=cam0: T_x\\nWATCHDOG=trigger\\nMAINPID=1\\x1b[2J"));
}

}  // namespace
}  // namespace waymark
