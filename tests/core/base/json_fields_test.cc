#include "core/base/json_fields.h"

#include <gmock/gmock.h>

#include <limits>

namespace waymark {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kName = "x.json";

/// What a reader says of a document; "" when all is well.
std::string said(const char* text, const std::function<void(JsonFields&)>& read) {
  const json document = json::parse(text);
  JsonFields fields(document, kName);
  read(fields);
  const Status status = fields.finish();
  return status ? "" : status.error().message;
}

TEST(JsonFields, ReadsWhatIsThereAndFallsBackWhereItMay) {
  const json document = json::parse(
      R"({"number": -1.5, "whole": 7, "flag": true, "text": "hall", "kind": "b",
          "three": [1, 2.5, -3], "names": ["x", "y"], "rest": null,
          "list": [{"id": 1}, {"id": 2}]})");
  JsonFields fields(document, kName);
  EXPECT_EQ(fields.number("number"), -1.5);
  EXPECT_EQ(fields.integer("whole", 0, 9), 7);
  EXPECT_EQ(fields.boolean("flag"), true);
  EXPECT_EQ(fields.text("text"), "hall");
  EXPECT_EQ(fields.choice("kind", {"a", "b"}), 1U);
  EXPECT_THAT(fields.numbers("three", 3), ElementsAre(1, 2.5, -3));
  EXPECT_THAT(fields.texts("names"), ElementsAre("x", "y"));
  EXPECT_TRUE(fields.contains("rest"));
  EXPECT_FALSE(fields.has("rest"));
  fields.allow("rest");
  EXPECT_EQ(fields.count("list"), 2U);
  std::vector<std::int64_t> ids;
  fields.each("list", [&](JsonFields& item) { ids.push_back(item.integer("id", 0, 5)); });
  EXPECT_THAT(ids, ElementsAre(1, 2));
  EXPECT_EQ(fields.number("absent", 0, 1, 0.5), 0.5);
  EXPECT_EQ(fields.integer("absent", 0, 1, 1), 1);
  EXPECT_EQ(fields.boolean("absent", true), true);
  EXPECT_EQ(fields.text("absent", "x"), "x");
  EXPECT_EQ(fields.choice("absent", {"a", "b"}, 1), 1U);
  EXPECT_THAT(fields.texts("absent"), ElementsAre());
  EXPECT_TRUE(fields.finish()) << fields.finish().error().message;
}

TEST(JsonFields, NothingIsConvertedOrNarrowed) {
  const auto whole = [](JsonFields& f) { f.integer("a", 0, 2147483647); };
  const std::string no_whole = "x.json: a: is no whole number from 0 to 2147483647";
  for (const char* text :
       {R"({"a": 12.7})", R"({"a": 4294967308})", R"({"a": -1})", R"({"a": 18446744073709551615})",
        R"({"a": 1e3})", R"({"a": "3"})", R"({"a": true})", R"({"a": null})", R"({"a": [3]})"}) {
    EXPECT_EQ(said(text, whole), no_whole) << text;
  }
  const auto any = [](JsonFields& f) {
    f.integer("a", std::numeric_limits<std::int64_t>::min(),
              std::numeric_limits<std::int64_t>::max());
  };
  EXPECT_EQ(said(R"({"a": 9223372036854775807})", any), "");
  EXPECT_EQ(said(R"({"a": -9223372036854775808})", any), "");
  EXPECT_THAT(said(R"({"a": 9223372036854775808})", any), HasSubstr("is no whole number"));
  const auto number = [](JsonFields& f) { f.number("a", 0, 1); };
  EXPECT_EQ(said(R"({"a": 1})", number), "");
  EXPECT_EQ(said(R"({"a": 1.5})", number), "x.json: a: 1.5 is not within 0 and 1");
  EXPECT_EQ(said(R"({"a": "1"})", number), "x.json: a: is no number");
  EXPECT_EQ(said(R"({"a": 1})", [](JsonFields& f) { f.text("a"); }), "x.json: a: is no text");
  EXPECT_EQ(said(R"({"a": 1})", [](JsonFields& f) { f.boolean("a"); }),
            "x.json: a: is neither true nor false");
  EXPECT_EQ(said(R"({"a": "c"})",
                 [](JsonFields& f) {
                   f.choice("a", {"b", "d"});
                 }),
            "x.json: a: is not one of \"b\", \"d\"");
  EXPECT_EQ(said(R"({"a": [1, "2"]})", [](JsonFields& f) { f.numbers("a", 2); }),
            "x.json: a[1]: is no number");
  EXPECT_EQ(said(R"({"a": [1]})", [](JsonFields& f) { f.numbers("a", 2); }),
            "x.json: a: is no list of 2 numbers");
  EXPECT_EQ(said(R"({"a": ["b", 1]})", [](JsonFields& f) { f.texts("a"); }),
            "x.json: a: is no list of texts");
}

TEST(JsonFields, SaysWhereInTheDocument) {
  const auto read = [](JsonFields& f) {
    f.each("submaps", [](JsonFields& submap) {
      submap.each("markers", [](JsonFields& marker) { marker.number("size_m"); });
    });
  };
  EXPECT_EQ(
      said(R"({"submaps": [{"markers": []}, {"markers": [{"size_m": 1}, {"size_m": ""}]}]})", read),
      "x.json: submaps[1].markers[1].size_m: is no number");
  EXPECT_EQ(said(R"({"submaps": [{"markers": [{}]}]})", read),
            "x.json: submaps[0].markers[0]: \"size_m\" is missing");
  EXPECT_EQ(said(R"({"submaps": [{"markers": [3]}]})", read),
            "x.json: submaps[0].markers[0]: is no object");
  EXPECT_EQ(said(R"({"submaps": [{"markers": [{"size_m": 1, "color": 2}]}]})", read),
            "x.json: submaps[0].markers[0]: unknown key \"color\"; known here: size_m");
  EXPECT_EQ(said(R"({"submaps": [{"markers": [{"size_mm": 1}]}]})", read),
            "x.json: submaps[0].markers[0]: unknown key \"size_mm\"; known here: size_m");
  EXPECT_EQ(said(R"({"submaps": {}})", read), "x.json: submaps: is no list");
  EXPECT_EQ(said("{}", read), "x.json: top level: \"submaps\" is missing");
  EXPECT_EQ(said("[]", read), "x.json: top level: is no object");
}

TEST(JsonFields, TheFirstThingThatIsWrongIsKept) {
  EXPECT_EQ(said(R"({"a": "x", "b": "y", "c": 1})",
                 [](JsonFields& f) {
                   EXPECT_EQ(f.number("a"), 0);
                   EXPECT_FALSE(f.good());
                   EXPECT_EQ(f.number("b"), 0);
                   f.reject("c", "is too late");
                 }),
            "x.json: a: is no number");
  EXPECT_EQ(said(R"({"a": 1})", [](JsonFields& f) { f.reject("a", "is odd"); }),
            "x.json: a: is odd");
}

}  // namespace
}  // namespace waymark
