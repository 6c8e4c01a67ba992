#include "mapbuilder/import/mcap_reader.h"
#include "tests/fuzz/file_of.h"
#include "tests/fuzz/format.h"
#include "tests/support/recordings.h"

namespace waymark::test {
namespace {

const std::vector<RecordedMessage> kMessages{{"/left", "sensor_msgs/msg/Image", "one message"},
                                             {"/tf", "tf2_msgs/msg/TFMessage", "another"},
                                             {"/left", "sensor_msgs/msg/Image", "a third"}};

/// To its end.
Status read(const std::string& bytes) {
  const auto reader =
      open_mcap(file_of(bytes), [](const BagTopic& topic) { return topic.name == "/left"; });
  if (!reader) return tl::make_unexpected(reader.error());
  for (;;) {
    const auto message = (*reader)->next();
    if (!message) return tl::make_unexpected(message.error());
    if (!*message) return {};
  }
}

const AddFormat mcap({"Mcap",
                      {mcap_of(kMessages, {"", 0, true}), mcap_of(kMessages, {"", 2, false}),
                       mcap_of(kMessages, {"lz4", 2, true}), mcap_of(kMessages, {"zstd", 3, true})},
                      {std::string(kMcapMagic), "lz4", "zstd", "cdr", "ros2msg", "/left",
                       "\x28\xB5\x2F\xFD", "\x04\x22\x4D\x18"},
                      reader(read)});

}  // namespace
}  // namespace waymark::test
