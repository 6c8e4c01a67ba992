#include "locd/publish/lcm_options.h"

#include <algorithm>

namespace waymark {

bool is_channel_prefix(std::string_view text) {
  return !text.empty() && text.size() <= kLongestChannelPrefix &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c <= '~'; });
}

}  // namespace waymark
