#include "mapbuilder/import/bag_images.h"

#include <algorithm>

#include "core/base/growing_folder.h"
#include "core/base/is_there.h"
#include "mapbuilder/import/bag_import.h"
#include "mapbuilder/import/ros_image.h"

namespace waymark {
namespace {

tl::unexpected<Error> about(const std::string& topic, const Error& error) {
  return fail(error.kind, "{}: {}", topic, error.message);
}

}  // namespace

bool BagImages::wants(const BagTopic& topic) {
  constexpr std::size_t kOthersToTell = 8;
  if (topic.type == kRosCameraInfo) return true;
  if (topic.type == kRosImage || topic.type == kRosCompressedImage) {
    return chosen_.empty() ||
           std::find(chosen_.begin(), chosen_.end(), topic.name) != chosen_.end();
  }
  const std::string told = fmt::format("{} ({})", topic.name, topic.type);
  const bool known = std::find(others_.begin(), others_.end(), told) != others_.end();
  if (!known && others_.size() < kOthersToTell) others_.push_back(told);
  return false;
}

Status BagImages::take(const BagMessage& message) {
  const BagTopic& topic = *message.topic;
  if (topic.encoding != "cdr") {
    return fail(ErrorKind::bad_data, "{}: serialized as \"{}\"; cdr is read", topic.name,
                topic.encoding);
  }
  if (topic.type == kRosCameraInfo) return take_camera_info(message);
  const auto images = images_of(topic.name);
  if (!images) return tl::make_unexpected(images.error());
  if ((*images)->seen++ % static_cast<std::size_t>(every_) != 0) return {};
  return topic.type == kRosImage ? take_raw(message, **images) : take_compressed(message, **images);
}

Expected<TopicImages*> BagImages::images_of(const std::string& topic) {
  const auto found = topics_.find(topic);
  if (found != topics_.end()) return &found->second;
  if (topics_.size() == kMostBagCameras) {
    return fail(ErrorKind::bad_data, "more than {} topics of images; choose some by --camera",
                kMostBagCameras);
  }
  // Which camera it becomes is known when all have been seen.
  TopicImages images;
  images.topic = topic;
  images.folder = folder_ / fmt::format("topic{}", topics_.size());
  if (auto created = create_folder(images.folder); !created) {
    return tl::make_unexpected(created.error());
  }
  return &topics_.emplace(topic, std::move(images)).first->second;
}

Status BagImages::take_camera_info(const BagMessage& message) {
  if (infos_.contains(message.topic->name)) return {};
  auto info = parse_ros_camera_info(message.data);
  if (!info) return about(message.topic->name, info.error());
  if (infos_.size() < kMostBagCameras) infos_.emplace(message.topic->name, std::move(*info));
  return {};
}

Status BagImages::take_raw(const BagMessage& message, TopicImages& images) {
  const auto raw = parse_ros_image(message.data);
  if (!raw) return about(images.topic, raw.error());
  const auto pgm = pgm_of_ros_image(*raw);
  if (!pgm) return about(images.topic, pgm.error());
  if (images.form.empty()) images.form = raw->encoding;
  return write(raw->stamp, {raw->width_px, raw->height_px}, "pgm", *pgm, images);
}

Status BagImages::take_compressed(const BagMessage& message, TopicImages& images) {
  const auto compressed = parse_ros_compressed_image(message.data);
  if (!compressed) return about(images.topic, compressed.error());
  const auto kind = kind_of_compressed(*compressed);
  if (!kind) {
    // A camera's glitch is no reason to leave out all the others.
    if (images.unreadable++ == 0) images.first_unreadable = kind.error().message;
    return {};
  }
  if (images.form.empty()) images.form = kind->ending;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes of a file
  const auto* const bytes = reinterpret_cast<const char*>(compressed->data.data());
  return write(compressed->stamp, kind->size, kind->ending, {bytes, compressed->data.size()},
               images);
}

Status BagImages::write(Stamp stamp, ImageSize size, const char* ending, std::string_view bytes,
                        TopicImages& images) {
  if (stamp == Stamp(0)) {
    return fail(ErrorKind::bad_data,
                "{}: header.stamp is 0: its driver does not say when images were taken",
                images.topic);
  }
  if (images.size && *images.size != size) {
    return fail(ErrorKind::bad_data, "{}: images of {}×{} and of {}×{}; one camera has one size",
                images.topic, images.size->width_px, images.size->height_px, size.width_px,
                size.height_px);
  }
  images.size = size;
  images.earliest = std::min(images.earliest, stamp);
  const auto path = images.folder / fmt::format("{}.{}", stamp.count(), ending);
  if (is_there(path)) {
    ++images.same_stamp;
    return {};
  }
  ++images.written;
  ++written_;
  return write_new_file(path, bytes);
}

}  // namespace waymark
