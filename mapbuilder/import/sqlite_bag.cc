#include "mapbuilder/import/sqlite_bag.h"

#include <sqlite3.h>

#include <algorithm>
#include <map>

#include "core/base/input_file.h"

namespace waymark {
namespace {

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;

struct EndStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Statement = std::unique_ptr<sqlite3_stmt, EndStatement>;

/// As part of a URI, in which some characters mean something.
std::string uri_of(const std::filesystem::path& path) {
  std::string uri = "file:";
  for (const char c : path.string()) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '/' || c == '.' || c == '-' || c == '_';
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  // Neither locks nor journals: nothing is written beside the file, nor taken from there.
  return uri + "?immutable=1";
}

std::string_view text_of(sqlite3_stmt* row, int column) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the library's texts are unsigned
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
  const int size = sqlite3_column_bytes(row, column);
  return text == nullptr ? std::string_view()
                         : std::string_view(text, static_cast<std::size_t>(size));
}

class SqliteBag : public BagReader {
 public:
  SqliteBag(std::string name, std::uintmax_t size, WantsTopic wants)
      : name_(std::move(name)), size_(size), wants_(std::move(wants)), steps_left_(1000 + size) {}

  Status open(const std::filesystem::path& path) {
    sqlite3* opened = nullptr;
    const int status = sqlite3_open_v2(uri_of(path).c_str(), &opened,
                                       SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(opened);
    if (status != SQLITE_OK) return damaged();
    bound();
    return read_layout();
  }

  Expected<std::optional<BagMessage>> next() override {
    for (;;) {
      const int status = sqlite3_step(messages_.get());
      if (status == SQLITE_DONE) return std::nullopt;
      if (status != SQLITE_ROW) return tl::make_unexpected(damaged().error());
      const auto topic = topics_.find(sqlite3_column_int64(messages_.get(), 0));
      if (topic == topics_.end() || !topic->second.wanted) continue;
      const auto* data = static_cast<const std::uint8_t*>(sqlite3_column_blob(messages_.get(), 1));
      const auto bytes = static_cast<std::size_t>(sqlite3_column_bytes(messages_.get(), 1));
      if (bytes > 0 && data == nullptr) return tl::make_unexpected(damaged().error());
      position_ += bytes;
      return BagMessage{&topic->second.topic, {data, bytes}};
    }
  }

  [[nodiscard]] std::uintmax_t position() const override { return std::min(position_, size_); }

 private:
  struct StoredTopic {
    BagTopic topic;
    bool wanted = false;
  };

  /// What the file can make the library do.
  void bound() {
    constexpr std::uintmax_t kMostValue = 1'000'000'000;
    sqlite3_limit(database_.get(), SQLITE_LIMIT_LENGTH,
                  static_cast<int>(std::min(size_ + 65536, kMostValue)));
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_db_config(database_.get(), SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
    sqlite3_progress_handler(database_.get(), kStepsAtOnce, &SqliteBag::has_done_enough, this);
  }

  /// The library's steps count against the file's size: rows that lead in circles end.
  static int has_done_enough(void* self) {
    std::uintmax_t& left = static_cast<SqliteBag*>(self)->steps_left_;
    left -= std::min<std::uintmax_t>(left, 1);
    return left == 0 ? 1 : 0;
  }

  [[nodiscard]] Status damaged() const {
    const char* const why = database_ ? sqlite3_errmsg(database_.get()) : "out of memory";
    return fail(ErrorKind::bad_data, "{}: damaged or truncated database of rosbag2: {}", name_,
                why);
  }

  Expected<Statement> prepare(const char* query) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database_.get(), query, -1, &statement, nullptr) != SQLITE_OK) {
      return tl::make_unexpected(damaged().error());
    }
    return Statement(statement);
  }

  Status read_layout() {
    if (auto plain = check_tables(); !plain) return plain;
    if (auto topics = read_topics(); !topics) return topics;
    // No index has the order of writing and the data; rowid has both.
    auto messages = prepare("SELECT topic_id, data FROM messages NOT INDEXED ORDER BY rowid");
    if (!messages) return tl::make_unexpected(messages.error());
    messages_ = std::move(*messages);
    return {};
  }

  /// Both are tables that are stored, without columns that are computed.
  Status check_tables() {
    auto counted = prepare(
        "SELECT (SELECT count(*) FROM sqlite_schema WHERE name IN ('topics', 'messages') AND type "
        "= "
        "'table' AND rootpage > 0), (SELECT count(*) FROM pragma_table_xinfo('topics') WHERE "
        "hidden "
        "<> 0) + (SELECT count(*) FROM pragma_table_xinfo('messages') WHERE hidden <> 0)");
    if (!counted) return tl::make_unexpected(counted.error());
    if (sqlite3_step(counted->get()) != SQLITE_ROW) return damaged();
    if (sqlite3_column_int(counted->get(), 0) == 2 && sqlite3_column_int(counted->get(), 1) == 0) {
      return {};
    }
    return fail(
        ErrorKind::bad_data,
        "{}: an SQLite database, but no recording of rosbag2: it lacks the tables topics and "
        "messages",
        name_);
  }

  Status read_topics() {
    const auto topics = prepare("SELECT id, name, type, serialization_format FROM topics");
    if (!topics) return tl::make_unexpected(topics.error());
    for (;;) {
      const int status = sqlite3_step(topics->get());
      if (status == SQLITE_DONE) return {};
      if (status != SQLITE_ROW) return damaged();
      StoredTopic stored;
      sqlite3_stmt* const row = topics->get();
      for (int column = 1; column <= 3; ++column) {
        if (text_of(row, column).size() <= BagLimits::kLongestName) continue;
        return fail(ErrorKind::bad_data, "{}: damaged: a topic's name is too long", name_);
      }
      stored.topic = {std::string(text_of(row, 1)), std::string(text_of(row, 2)),
                      std::string(text_of(row, 3))};
      if (topics_.size() == BagLimits::kMostTopics) {
        return fail(ErrorKind::bad_data, "{}: damaged: too many topics", name_);
      }
      stored.wanted = wants_(stored.topic);
      topics_.try_emplace(sqlite3_column_int64(row, 0), std::move(stored));
    }
  }

  static constexpr int kStepsAtOnce = 1000;

  std::string name_;
  std::uintmax_t size_;
  WantsTopic wants_;
  std::uintmax_t steps_left_;  ///< thousands of them
  Database database_;
  std::map<std::int64_t, StoredTopic> topics_;
  Statement messages_;  ///< behind the database: statements end first
  std::uintmax_t position_ = 0;
};

/// What a writer that never ended left beside the file, and holds messages.
std::optional<std::filesystem::path> journal_of(const std::filesystem::path& path) {
  for (const char* ending : {"-wal", "-journal"}) {
    std::filesystem::path journal = path;
    journal += ending;
    std::error_code absent;
    const std::uintmax_t size = std::filesystem::file_size(journal, absent);
    if (!absent && size > 0) return journal;
  }
  return std::nullopt;
}

}  // namespace

Expected<std::unique_ptr<BagReader>> open_sqlite_bag(const std::filesystem::path& path,
                                                     WantsTopic wants) {
  const auto file = InputFile::open(path, BagLimits::kLargestFile);
  if (!file) return tl::make_unexpected(file.error());
  if (const auto journal = journal_of(path)) {
    return fail(ErrorKind::bad_data,
                "{}: its recorder did not end: {} holds more of it; sqlite3 FILE 'PRAGMA "
                "wal_checkpoint(TRUNCATE)' writes it back",
                path.string(), journal->filename().string());
  }
  auto bag = std::make_unique<SqliteBag>(path.string(), file->size(), std::move(wants));
  if (auto opened = bag->open(path); !opened) return tl::make_unexpected(opened.error());
  return bag;
}

}  // namespace waymark
