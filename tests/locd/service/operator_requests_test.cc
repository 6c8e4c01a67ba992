#include "locd/service/operator_requests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace waymark {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr Stamp kNow = std::chrono::seconds(1);

class OperatorRequestsTest : public testing::Test {
 protected:
  OperatorRequestsTest() {
    requests_.add("status", "", [](auto, Stamp) {
      return at_once(ControlAnswer{"all\nwell", {{"sets", 7}}});
    });
    requests_.add("mark", "[TEXT]", [](auto text, Stamp) {
      return at_once(ControlAnswer{"marked " + std::string(text), {}});
    });
    requests_.add("ignore", "ID", [](auto id, Stamp) {
      return at_once(fail(ErrorKind::bad_data, "{} is no id", id));
    });
    requests_.add("reload", "", [](auto, Stamp) -> PendingReply {
      return [](Stamp now) -> std::optional<ControlReply> {
        if (now == kNow) return std::nullopt;
        return ControlAnswer{"reloaded", {}};
      };
    });
  }
  /// The answer that is there at once.
  [[nodiscard]] std::string ask(std::string_view line) const {
    return requests_.handle(line, kNow)(kNow).value_or("nothing yet");
  }
  [[nodiscard]] nlohmann::json ask_for_json(const std::string& line) const {
    return nlohmann::json::parse(ask("json " + line));
  }

  OperatorRequests requests_;
};

TEST_F(OperatorRequestsTest, PeopleAreAnsweredWithALine) {
  EXPECT_EQ(ask("status"), "ok all\\nwell");
  EXPECT_EQ(ask("mark"), "ok marked ");
  EXPECT_EQ(ask("mark  the third aisle "), "ok marked the third aisle");
  EXPECT_EQ(ask("ignore 12,"), "error: 12, is no id");
}

TEST_F(OperatorRequestsTest, ProgramsAreAnsweredWithAnObject) {
  EXPECT_EQ(ask_for_json("status"),
            nlohmann::json({{"ok", true}, {"text", "all\\nwell"}, {"sets", 7}}));
  EXPECT_EQ(ask_for_json("ignore 12,"),
            nlohmann::json({{"ok", false}, {"code", 65}, {"text", "12, is no id"}}));
}

TEST_F(OperatorRequestsTest, AnAnswerMayTakeItsTime) {
  const auto answer = requests_.handle("reload", kNow);
  EXPECT_FALSE(answer(kNow));
  EXPECT_EQ(answer(2 * kNow), "ok reloaded");
}

TEST_F(OperatorRequestsTest, WhatIsNoRequestIsToldWhichThereAre) {
  for (const char* line : {"", " ", "json", "json ", "statu", "status now", "ignore", "STATUS",
                           "\x01\xff\n", "shutdown -h"}) {
    const std::string answer = ask(line);
    EXPECT_EQ(answer.find('\n'), std::string::npos);
    if (std::string_view(line).starts_with("json")) {
      EXPECT_EQ(nlohmann::json::parse(answer)["code"], 64) << line;
    } else {
      EXPECT_THAT(answer, StartsWith("error: ")) << line;
    }
  }
  EXPECT_THAT(ask("shutdown"), HasSubstr("status, mark [TEXT], ignore ID, reload"));
  EXPECT_THAT(ask("ignore"), HasSubstr("ignore ID"));
}

TEST_F(OperatorRequestsTest, WhatIsNoTextIsStillAnObject) {
  EXPECT_FALSE(ask_for_json("mark \xff\xfe").empty());
  EXPECT_FALSE(ask_for_json("ignore \xc3").empty());
}

}  // namespace
}  // namespace waymark
