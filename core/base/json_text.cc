#include "core/base/json_text.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/atomic_file.h"

namespace waymark {
namespace {

using nlohmann::json;

/// Builds the document from the parser's events, within its bounds. The functions' names and
/// signatures are the parser's; false ends it.
class BoundedBuilder {
 public:
  explicit BoundedBuilder(std::size_t text_bytes)
      : left_(kJsonBytesForAny + kJsonBytesPerByte * text_bytes) {}

  bool null() { return add(nullptr, 0); }
  bool boolean(bool value) { return add(value, 0); }
  bool number_integer(std::int64_t value) { return add(value, 0); }
  bool number_unsigned(std::uint64_t value) { return add(value, 0); }
  bool number_float(double value, const std::string& /*digits*/) { return add(value, 0); }
  bool string(std::string& value) {
    const std::size_t bytes = kStringBytes + value.size();
    return add(std::move(value), bytes);
  }
  bool binary(json::binary_t& /*value*/) { return refuse("binary data"); }

  bool start_object(std::size_t /*members*/) { return open(json::object()); }
  bool key(std::string& name) {
    auto& members = open_.back()->get_ref<json::object_t&>();
    if (!charge(kMemberBytes + name.size())) return false;
    const auto [member, is_new] = members.try_emplace(std::move(name));
    if (!is_new) return refuse(fmt::format("\"{}\" stands there twice", member->first));
    member_ = &member->second;
    return true;
  }
  bool end_object() { return close(); }
  bool start_array(std::size_t /*elements*/) { return open(json::array()); }
  bool end_array() { return close(); }

  bool parse_error(std::size_t /*position*/, const std::string& /*token*/,
                   const json::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 3, column 7: …"
    const std::string_view why = error.what();
    const auto number_end = why.find("] ");
    return refuse(
        fmt::format("not valid JSON: {}",
                    why.substr(number_end == std::string_view::npos ? 0 : number_end + 2)));
  }

  [[nodiscard]] const std::string& refusal() const { return refusal_; }
  [[nodiscard]] json take() { return std::move(root_); }

 private:
  // What each takes in memory, with what the allocator adds and what growing costs.
  static constexpr std::size_t kValueBytes = 2 * sizeof(json);
  static constexpr std::size_t kStringBytes = 64;
  static constexpr std::size_t kContainerBytes = 64;
  static constexpr std::size_t kMemberBytes = 96;

  bool add(json value, std::size_t more_bytes) {
    if (!charge(kValueBytes + more_bytes)) return false;
    place(std::move(value));
    return true;
  }

  json& place(json value) {
    if (open_.empty()) return root_ = std::move(value);
    if (open_.back()->is_object()) return *member_ = std::move(value);
    open_.back()->push_back(std::move(value));
    return open_.back()->back();
  }

  bool open(json container) {
    if (open_.size() == kMaxJsonDepth) {
      return refuse(
          fmt::format("nested deeper than {} levels; this is not such a file", kMaxJsonDepth));
    }
    if (!charge(kContainerBytes + kValueBytes)) return false;
    open_.push_back(&place(std::move(container)));
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  bool charge(std::size_t bytes) {
    if (bytes > left_) return refuse("far more values than such a file holds");
    left_ -= bytes;
    return true;
  }

  bool refuse(std::string why) {
    refusal_ = std::move(why);
    return false;
  }

  json root_;
  std::vector<json*> open_;  ///< the containers around what comes next
  json* member_ = nullptr;   ///< of the innermost object, named last
  std::size_t left_;
  std::string refusal_;
};

}  // namespace

Expected<json> parse_json(std::string_view text, const std::string& name, std::size_t max_bytes) {
  if (text.size() > max_bytes) {
    return fail(ErrorKind::bad_data, "{}: larger than {} bytes; this is not such a file", name,
                max_bytes);
  }
  BoundedBuilder builder(text.size());
  if (!json::sax_parse(text, &builder)) {
    return fail(ErrorKind::bad_data, "{}: {}", name, builder.refusal());
  }
  return builder.take();
}

Expected<json> read_json(const std::filesystem::path& path, std::size_t max_bytes) {
  const auto text = read_file(path, max_bytes);
  if (!text) return tl::make_unexpected(text.error());
  return parse_json(*text, path.string(), max_bytes);
}

}  // namespace waymark
