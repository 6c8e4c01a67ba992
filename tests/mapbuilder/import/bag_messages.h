#pragma once

#include <string>
#include <vector>

#include "mapbuilder/import/bag_reader.h"
#include "tests/support/recordings.h"

namespace waymark::test {

/// What a reader gives until its end, or until what is wrong.
struct BagContent {
  std::vector<RecordedMessage> messages;
  std::string error;
};

inline BagContent content_of(const Expected<std::unique_ptr<BagReader>>& reader) {
  BagContent content;
  if (!reader) {
    content.error = reader.error().message;
    return content;
  }
  for (;;) {
    const auto message = (*reader)->next();
    if (!message) {
      content.error = message.error().message;
      return content;
    }
    if (!*message) return content;
    const BagTopic& topic = *(*message)->topic;
    content.messages.push_back(
        {topic.name, topic.type, {(*message)->data.begin(), (*message)->data.end()}});
  }
}

inline bool operator==(const RecordedMessage& a, const RecordedMessage& b) {
  return a.topic == b.topic && a.type == b.type && a.data == b.data;
}

inline bool any_topic(const BagTopic& /*topic*/) { return true; }

/// Of two topics, and one in between of another type.
inline std::vector<RecordedMessage> some_messages() {
  std::vector<RecordedMessage> messages;
  for (int i = 0; i < 4; ++i) {
    const std::string number = std::to_string(i);
    messages.push_back({"/left", "sensor_msgs/msg/Image", "left " + number});
    messages.push_back({"/tf", "tf2_msgs/msg/TFMessage", std::string(5000, 't')});
    messages.push_back({"/right", "sensor_msgs/msg/Image", std::string(1000, 'r') + number});
  }
  return messages;
}

}  // namespace waymark::test
