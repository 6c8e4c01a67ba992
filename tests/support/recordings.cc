#include "tests/support/recordings.h"

#include <gtest/gtest.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

#include <map>
#include <memory>

namespace waymark::test {
namespace {

/// Ids by names, in the order in which they are met.
using Ids = std::map<std::string, std::uint16_t>;

std::string schema_and_channel(const RecordedMessage& message, std::uint16_t id) {
  const std::string schema =
      Bytes().number(id).text(message.type).text("ros2msg").text("# a definition\n").str();
  const std::string channel =
      Bytes().number(id).number(id).text(message.topic).text("cdr").text("").str();
  return mcap_record(0x03, schema) + mcap_record(0x04, channel);
}

std::string message_record(const RecordedMessage& message, std::uint16_t id) {
  return mcap_record(0x05, Bytes()
                               .number(id)
                               .number(std::uint32_t{0})
                               .number(std::uint64_t{1})
                               .number(std::uint64_t{1})
                               .raw(message.data)
                               .str());
}

void run(sqlite3* database, const std::string& statements) {
  char* why = nullptr;
  ASSERT_EQ(sqlite3_exec(database, statements.c_str(), nullptr, nullptr, &why), SQLITE_OK) << why;
}

}  // namespace

RecordedMessage raw_image(const std::string& topic, Stamp stamp, std::uint32_t width,
                          std::uint32_t height, const std::string& encoding, std::uint32_t step,
                          std::string_view data) {
  Cdr cdr;
  cdr.header(stamp).number(height).number(width).text(encoding).number(std::uint8_t{0});
  return {topic, "sensor_msgs/msg/Image", cdr.number(step).bytes(data).str()};
}

RecordedMessage raw_image(const std::string& topic, Stamp stamp, const GrayImage& image) {
  const auto width = static_cast<std::uint32_t>(image.width_px);
  const std::string pixels(image.pixels.begin(), image.pixels.end());
  return raw_image(topic, stamp, width, static_cast<std::uint32_t>(image.height_px), "mono8", width,
                   pixels);
}

RecordedMessage compressed_image(const std::string& topic, Stamp stamp, const std::string& format,
                                 std::string_view file) {
  return {topic, "sensor_msgs/msg/CompressedImage",
          Cdr().header(stamp).text(format).bytes(file).str()};
}

RecordedMessage camera_info(const std::string& topic, std::uint32_t width, std::uint32_t height,
                            double focal_px, std::uint32_t binning) {
  Cdr cdr;
  cdr.header(std::chrono::seconds(1)).number(height).number(width).text("plumb_bob");
  cdr.number(std::uint32_t{5});
  for (int i = 0; i < 5; ++i) cdr.number(0.0);
  const double u = (width - 1) / 2.0;
  const double v = (height - 1) / 2.0;
  for (const double k : {focal_px, 0.0, u, 0.0, focal_px, v, 0.0, 0.0, 1.0}) cdr.number(k);
  for (const double r : {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}) cdr.number(r);
  for (const double p :
       {2 * focal_px, 0.0, u, 0.0, 0.0, 2 * focal_px, v, 0.0, 0.0, 0.0, 1.0, 0.0}) {
    cdr.number(p);
  }
  cdr.number(binning).number(binning);
  for (int i = 0; i < 4; ++i) cdr.number(std::uint32_t{0});
  return {topic, "sensor_msgs/msg/CameraInfo", cdr.number(std::uint8_t{0}).str()};
}

std::string mcap_record(std::uint8_t op, std::string_view content) {
  return Bytes().number(op).number(std::uint64_t{content.size()}).raw(content).str();
}

std::string mcap_chunk(const std::string& records, const McapForm& form,
                       std::uint64_t stated_bytes) {
  const auto* const data = reinterpret_cast<const Bytef*>(records.data());  // NOLINT: zlib's bytes
  const auto checksum =
      form.checksums ? static_cast<std::uint32_t>(crc32_z(0, data, records.size())) : 0U;
  std::string packed = records;
  if (form.compression == "zstd") packed = zstd_of(records);
  if (form.compression == "lz4") packed = lz4_of(records);
  return mcap_record(0x06, Bytes()
                               .number(std::uint64_t{0})
                               .number(std::uint64_t{9})
                               .number(stated_bytes)
                               .number(checksum)
                               .text(form.compression)
                               .number(std::uint64_t{packed.size()})
                               .raw(packed)
                               .str());
}

std::string mcap_of(const std::vector<RecordedMessage>& messages, const McapForm& form) {
  std::string file(kMcapMagic);
  file += mcap_record(0x01, Bytes().text("ros2").text("test").str());
  std::string records;
  Ids ids;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const RecordedMessage& message = messages[i];
    const auto [id, is_new] =
        ids.emplace(message.topic, static_cast<std::uint16_t>(ids.size() + 1));
    if (is_new) records += schema_and_channel(message, id->second);
    records += message_record(message, id->second);
    if (form.chunk == 0 || (i + 1) % form.chunk != 0) continue;
    file += mcap_chunk(records, form, records.size()) + mcap_record(0x07, "an index");
    records.clear();
  }
  if (!records.empty()) {
    file += form.chunk == 0 ? records : mcap_chunk(records, form, records.size());
  }
  file += mcap_record(0x0F, std::string(4, '\0'));
  return file + mcap_record(0x02, std::string(20, '\0')) + std::string(kMcapMagic);
}

void write_sqlite(const std::filesystem::path& path, const std::string& statements) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  run(database, statements);
  sqlite3_close(database);
}

void write_sqlite_bag(const std::filesystem::path& path,
                      const std::vector<RecordedMessage>& messages) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  run(database,
      "PRAGMA synchronous=OFF; BEGIN; CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, "
      "ros_distro TEXT NOT NULL);"
      "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
      "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER "
      "NOT NULL, data BLOB NOT NULL);"
      "CREATE INDEX timestamp_idx ON messages (timestamp ASC);");
  Ids ids;
  sqlite3_stmt* insert = nullptr;
  sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)",
                     -1, &insert, nullptr);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const RecordedMessage& message = messages[i];
    const auto [id, is_new] =
        ids.emplace(message.topic, static_cast<std::uint16_t>(ids.size() + 1));
    if (is_new) {
      run(database, "INSERT INTO topics VALUES (" + std::to_string(id->second) + ", '" +
                        message.topic + "', '" + message.type + "', 'cdr', '')");
    }
    sqlite3_bind_int(insert, 1, id->second);
    sqlite3_bind_int64(insert, 2, static_cast<sqlite3_int64>(i));
    sqlite3_bind_blob(insert, 3, message.data.data(), static_cast<int>(message.data.size()),
                      SQLITE_STATIC);
    ASSERT_EQ(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_reset(insert);
  }
  sqlite3_finalize(insert);
  run(database, "COMMIT");
  sqlite3_close(database);
}

std::string zstd_of(std::string_view bytes, int window_log) {
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(),
                                                                     &ZSTD_freeCCtx);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_windowLog, window_log);
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size =
      ZSTD_compress2(context.get(), packed.data(), packed.size(), bytes.data(), bytes.size());
  EXPECT_FALSE(ZSTD_isError(size));
  packed.resize(size);
  return packed;
}

std::string lz4_of(std::string_view bytes) {
  std::string packed(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
  const std::size_t size =
      LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr);
  EXPECT_FALSE(LZ4F_isError(size));
  packed.resize(size);
  return packed;
}

}  // namespace waymark::test
