#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.h"
#include "core/capture/image_size.h"
#include "core/geometry/stamp.h"
#include "mapbuilder/import/bag_reader.h"
#include "mapbuilder/import/ros_messages.h"

namespace waymark {

/// What a recording has of one topic of images, as far as it is read.
struct TopicImages {
  std::string topic;
  std::filesystem::path folder;   ///< where they are written
  std::size_t seen = 0;           ///< messages
  std::size_t written = 0;        ///< files
  std::size_t same_stamp = 0;     ///< left out: their stamp was there
  std::size_t unreadable = 0;     ///< left out: no JPEG or PNG
  std::string first_unreadable;   ///< why
  std::string form;               ///< of the first: "mono8", "jpg"
  std::optional<ImageSize> size;  ///< of all
  Stamp earliest = Stamp::max();
};

/// Writes the images of a recording's messages into a folder for each topic, and keeps the first
/// camera_info of each of those.
class BagImages {
 public:
  /// `chosen`: topics of images that are wanted, all if empty; one of so many is taken.
  BagImages(std::filesystem::path folder, std::vector<std::string> chosen, int every)
      : folder_(std::move(folder)), chosen_(std::move(chosen)), every_(every) {}

  /// Whether messages of the topic are to be given to `take`.
  [[nodiscard]] bool wants(const BagTopic& topic);

  /// Errors: bad_data, with the topic's name, for damaged messages, images that are not read or
  /// change their size, and stamps of 0; those of write_new_file.
  [[nodiscard]] Status take(const BagMessage& message);

  /// By name.
  [[nodiscard]] const std::map<std::string, TopicImages>& topics() const { return topics_; }
  [[nodiscard]] const std::map<std::string, RosCameraInfo>& camera_infos() const { return infos_; }
  /// Of topics that are no images, some with their types, for who expected others.
  [[nodiscard]] const std::vector<std::string>& others() const { return others_; }
  /// Images written of all topics.
  [[nodiscard]] std::size_t written() const { return written_; }

 private:
  [[nodiscard]] Status take_raw(const BagMessage& message, TopicImages& images);
  [[nodiscard]] Status take_compressed(const BagMessage& message, TopicImages& images);
  [[nodiscard]] Status take_camera_info(const BagMessage& message);
  [[nodiscard]] Status write(Stamp stamp, ImageSize size, const char* ending,
                             std::string_view bytes, TopicImages& images);
  [[nodiscard]] Expected<TopicImages*> images_of(const std::string& topic);

  std::filesystem::path folder_;
  std::vector<std::string> chosen_;
  int every_;
  std::map<std::string, TopicImages> topics_;
  std::map<std::string, RosCameraInfo> infos_;
  std::vector<std::string> others_;
  std::size_t written_ = 0;
};

}  // namespace waymark
