#include "mapbuilder/import/rosbag2.h"

#include "core/base/atomic_file.h"
#include "core/base/is_there.h"
#include "core/camera/kalibr.h"
#include "core/camera/yaml_text.h"
#include "mapbuilder/import/mcap_reader.h"
#include "mapbuilder/import/recorded_file.h"
#include "mapbuilder/import/sqlite_bag.h"
#include "mapbuilder/import/unpacked_source.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// Messages of a file, those unpacked that its recorder packed one by one: what is CDR begins with
/// two zeros or a 0 and a 1, never as zstd does.
class UnpackedMessages : public BagReader {
 public:
  UnpackedMessages(fs::path path, std::uintmax_t size, std::unique_ptr<BagReader> packed)
      : path_(std::move(path)), size_(size), packed_(std::move(packed)) {}

  Expected<std::optional<BagMessage>> next() override {
    auto message = packed_->next();
    if (!message || !*message || !looks_like_zstd((*message)->data)) return message;
    const std::uintmax_t left = BagLimits::most_unpacked(size_) - unpacked_;
    auto data = unpack_zstd((*message)->data,
                            std::min<std::uintmax_t>(left, BagLimits::largest_message(size_)));
    if (!data) {
      return fail(ErrorKind::bad_data, "{}: a message of {}: {}", path_.string(),
                  (*message)->topic->name, data.error().message);
    }
    data_ = std::move(*data);
    unpacked_ += data_.size();
    return BagMessage{(*message)->topic, data_};
  }

  [[nodiscard]] std::uintmax_t position() const override { return packed_->position(); }

 private:
  fs::path path_;
  std::uintmax_t size_;
  std::unique_ptr<BagReader> packed_;
  std::vector<std::uint8_t> data_;
  std::uintmax_t unpacked_ = 0;
};

/// What `rosbag2_bagfile_information: relative_file_paths` lists; undefined where there is none.
YAML::Node listed_files(const YAML::Node& root) {
  if (!root.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
  const YAML::Node information = root["rosbag2_bagfile_information"];
  if (!information.IsDefined() || !information.IsMap()) {
    return YAML::Node(YAML::NodeType::Undefined);
  }
  return information["relative_file_paths"];
}

Expected<std::vector<fs::path>> files_of_folder(const fs::path& folder) {
  const fs::path metadata = folder / "metadata.yaml";
  if (!is_there(metadata)) {
    return fail(ErrorKind::bad_data,
                "{}: a folder without metadata.yaml is no recording of rosbag2; ros2 bag reindex "
                "writes it, or name one of its files",
                folder.string());
  }
  const auto text = read_file(metadata, kMaxCamchainBytes);
  if (!text) return tl::make_unexpected(text.error());
  const auto root = parse_yaml(*text, metadata.string());
  if (!root) return tl::make_unexpected(root.error());
  std::vector<fs::path> files;
  const YAML::Node listed = listed_files(*root);
  if (listed.IsDefined() && listed.IsSequence()) {
    for (const auto& item : listed) {
      // Where the folder was when it was recorded no longer matters.
      if (item.IsScalar()) files.push_back(folder / fs::path(item.Scalar()).filename());
    }
  }
  if (!files.empty()) return files;
  return fail(ErrorKind::bad_data,
              "{}: it names no files (rosbag2_bagfile_information: relative_file_paths)",
              metadata.string());
}

Expected<std::unique_ptr<BagReader>> open_storage(const fs::path& file, RecordedFile kind,
                                                  WantsTopic wants) {
  switch (kind) {
    case RecordedFile::mcap:
      return open_mcap(file, std::move(wants));
    case RecordedFile::sqlite:
      return open_sqlite_bag(file, std::move(wants));
    case RecordedFile::ros1_bag:
      return fail(
          ErrorKind::bad_data,
          "{0}: a recording of ROS 1; rosbags-convert --src {0} --dst BAG (of PyPI's rosbags, "
          "without ROS) makes one of ROS 2",
          file.string());
    case RecordedFile::zstd:
      return fail(ErrorKind::bad_data,
                  "{0}: packed as a whole; zstd -d {0} unpacks it, and then name what comes",
                  file.string());
    case RecordedFile::lcm_log:
    case RecordedFile::other:
      break;
  }
  return fail(ErrorKind::bad_data, "{}: no recording of ROS 2: neither MCAP nor SQLite",
              file.string());
}

}  // namespace

Expected<std::vector<fs::path>> files_of_recording(const fs::path& recording) {
  std::error_code ignored;
  if (fs::is_directory(recording, ignored)) return files_of_folder(recording);
  return std::vector<fs::path>{recording};
}

Expected<std::unique_ptr<BagReader>> open_recorded(const fs::path& file, WantsTopic wants) {
  const auto kind = kind_of_file(file);
  if (!kind) return tl::make_unexpected(kind.error());
  auto opened = open_storage(file, *kind, std::move(wants));
  if (!opened) return opened;
  std::error_code absent;
  const std::uintmax_t size = fs::file_size(file, absent);
  return std::make_unique<UnpackedMessages>(file, absent ? 0 : size, std::move(*opened));
}

}  // namespace waymark
