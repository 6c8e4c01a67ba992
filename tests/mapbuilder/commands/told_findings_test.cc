#include "mapbuilder/commands/told_findings.h"

#include <gmock/gmock.h>

#include <sstream>

namespace waymark {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Finding of(Severity severity, Cause cause, const char* subject) {
  Finding finding;
  finding.severity = severity;
  finding.cause = cause;
  finding.subject = subject;
  finding.text = "text.";
  return finding;
}

std::vector<Finding> some() {
  return {of(Severity::note, Cause::scale_unknown, "scale"),
          of(Severity::warning, Cause::wrong_id, "marker 1"),
          of(Severity::warning, Cause::moved, "marker 2"),
          of(Severity::warning, Cause::wrong_id, "marker 3"),
          of(Severity::error, Cause::wrong_id, "marker 4")};
}

TEST(ToldFindings, TheWorstComeFirstAndEveryCauseOnce) {
  std::ostringstream notes;
  print_findings(judged(some(), {}), notes);
  EXPECT_EQ(notes.str(),
            "error [wrong_id] marker 4: text. (and 2 more of [wrong_id]: --report shows all)\n"
            "warning [moved] marker 2: text.\n"
            "note [scale_unknown] scale: text.\n");
}

TEST(ToldFindings, WarningsAreErrorsWhereThatIsAskedFor) {
  const auto findings = judged(some(), {true, false});
  EXPECT_EQ(count_of(Severity::error, findings), 4U);
  EXPECT_EQ(count_of(Severity::note, findings), 1U);
}

TEST(ToldFindings, AnErrorStandsAgainstAResultUnlessAccepted) {
  auto findings = judged(some(), {});
  EXPECT_FALSE(may_stand(findings, {}));
  EXPECT_TRUE(may_stand(findings, {false, true}));
  findings.erase(findings.begin());
  EXPECT_TRUE(may_stand(findings, {}));
  EXPECT_TRUE(may_stand({}, {}));
}

TEST(ToldFindings, TheRefusalSaysWhatStandsAgainstWhatAndWhatToDo) {
  const Error one = refusal_of("hall.map", judged(some(), {}), "the map went to x");
  EXPECT_EQ(one.exit_code(), 65);
  EXPECT_THAT(one.message, HasSubstr("hall.map: an error stands against it; the map went to x"));
  EXPECT_THAT(one.message, HasSubstr("--accept-errors"));
  const Error four = refusal_of("hall.map", judged(some(), {true, false}), "");
  EXPECT_THAT(four.message, HasSubstr("4 errors stand against it"));
}

}  // namespace
}  // namespace waymark
