#include "mapbuilder/import/sqlite_bag.h"

#include "core/base/atomic_file.h"
#include "tests/fuzz/file_of.h"
#include "tests/fuzz/format.h"
#include "tests/support/recordings.h"
#include "tests/support/temporary_folder.h"

namespace waymark::test {
namespace {

std::string seed() {
  const TemporaryFolder folder;
  write_sqlite_bag(folder.path() / "a.db3",
                   {{"/left", "sensor_msgs/msg/Image", std::string(6000, 'x')},
                    {"/tf", "tf2_msgs/msg/TFMessage", "another"}});
  return read_file(folder.path() / "a.db3").value();
}

/// To its end.
Status read(const std::string& bytes) {
  const auto reader = open_sqlite_bag(file_of(bytes), [](const BagTopic&) { return true; });
  if (!reader) return tl::make_unexpected(reader.error());
  for (;;) {
    const auto message = (*reader)->next();
    if (!message) return tl::make_unexpected(message.error());
    if (!*message) return {};
  }
}

const AddFormat sqlite_bag({"SqliteBag",
                            {seed()},
                            {"SQLite format 3", "CREATE TABLE", "CREATE VIEW", "topics", "messages",
                             "topic_id", "INTEGER PRIMARY KEY", " AS SELECT "},
                            reader(read)});

}  // namespace
}  // namespace waymark::test
