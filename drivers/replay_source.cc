#include "drivers/replay_source.h"

#include <algorithm>
#include <condition_variable>
#include <map>

#include "core/base/check.h"
#include "core/base/median.h"
#include "core/capture/detections_csv.h"
#include "core/capture/edge_moves.h"
#include "core/capture/image_file.h"
#include "core/capture/stamp_doubt.h"
#include "core/capture/sync_tolerance.h"
#include "drivers/monotonic_clock.h"

namespace waymark {

/// One camera of a capture.
class ReplaySource final : public FrameSource, public FrameLender {
 public:
  ReplaySource(std::shared_ptr<ReplayCapture> capture, std::size_t camera)
      : capture_(std::move(capture)),
        camera_(capture_->folder().rig.cameras[camera]),
        entries_(capture_->entries_[camera]) {}

  [[nodiscard]] const std::string& name() const override { return camera_.name; }

  [[nodiscard]] Status start() override {
    const std::lock_guard lock(mutex_);
    stopped_ = false;
    capture_->begin_time_line();
    return {};
  }

  [[nodiscard]] Expected<std::optional<Frame>> next(Stamp deadline) override {
    // A round without one usable image is followed by others like it.
    for (std::size_t tried = 0; !ended(); ++tried) {
      if (tried == entries_.size()) {
        return fail(ErrorKind::io, "{}: {}: no image of {} can be used; the first: {}",
                    capture_->folder().path.string(), name(), tried,
                    capture_->unusable().first_reason);
      }
      if (!wait_until_due(deadline)) return std::nullopt;
      if (auto frame = take_entry()) return frame;
      if (capture_->options().realtime && monotonic_now() >= deadline) return std::nullopt;
    }
    return std::nullopt;
  }

  void stop() override {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    stopping_.notify_all();
  }

  [[nodiscard]] bool ended() const override { return !exists(position_); }

  [[nodiscard]] std::uint64_t damaged() const override { return damaged_; }

  [[nodiscard]] std::string describe() const override {
    const CameraParameters& size = camera_.model.parameters();
    return fmt::format("{}×{}, replayed{}", size.width_px, size.height_px,
                       capture_->options().loop ? " again and again" : "");
  }

  [[nodiscard]] Expected<DeviceReport> inspect() override {
    return DeviceReport{
        fmt::format("{}, {} frames", capture_->folder().path.string(), entries_.size()), {}};
  }

  void take_back(std::uint32_t slot) noexcept override {
    const std::lock_guard lock(mutex_);
    lent_[slot] = 0;
  }

 private:
  [[nodiscard]] const ReplayCapture::Entry& entry(std::size_t position) const {
    return entries_[position % entries_.size()];
  }
  [[nodiscard]] Stamp stamp_of(std::size_t position) const {
    const auto round = static_cast<std::int64_t>(position / entries_.size());
    return entry(position).stamp + capture_->shift() + round * capture_->round_;
  }
  [[nodiscard]] bool exists(std::size_t position) const {
    if (entries_.empty()) return false;
    const std::size_t rounds = capture_->options().loop ? capture_->most_rounds() : 1;
    return position / entries_.size() < rounds;
  }

  /// The last one that is due by `now`, if any is behind the present one: found, not walked to, for
  /// a short round has been over thousands of times after a pause.
  void skip_to_newest(Stamp now) {
    const Stamp since = now - capture_->shift() - entries_.front().stamp;
    std::size_t rounds = 0;
    if (capture_->options().loop && since > capture_->round_) {
      rounds =
          std::min(static_cast<std::size_t>(since / capture_->round_), capture_->most_rounds() - 1);
    }
    const Stamp within =
        now - capture_->shift() - static_cast<std::int64_t>(rounds) * capture_->round_;
    const auto behind = std::upper_bound(
        entries_.begin(), entries_.end(), within,
        [](Stamp due, const ReplayCapture::Entry& entry) { return due < entry.stamp; });
    const std::size_t due =
        rounds * entries_.size() + static_cast<std::size_t>(behind - entries_.begin());
    if (due > 0) position_ = std::max(position_, due - 1);
  }

  /// False when the deadline or a stop comes first.
  [[nodiscard]] bool wait_until_due(Stamp deadline) {
    std::unique_lock lock(mutex_);
    if (stopped_) return false;
    if (!capture_->options().realtime) return true;
    const Stamp due = stamp_of(position_);
    stopping_.wait_until(lock, as_time_point(std::min(due, deadline)), [&] { return stopped_; });
    if (stopped_ || monotonic_now() < due) return false;
    // As a camera does, whose buffers are overwritten: who comes late finds the newest.
    skip_to_newest(monotonic_now());
    return true;
  }

  /// nullopt when the image can't be read: counted, passed over.
  [[nodiscard]] std::optional<Frame> take_entry() {
    const std::size_t position = position_++;
    const ReplayCapture::Entry& taken = entry(position);
    FrameInfo info;
    info.stamp = stamp_of(position);
    info.arrival = capture_->options().realtime ? monotonic_now() : info.stamp;
    info.sequence = position;
    info.quality = StampQuality::replayed;
    const std::uint32_t slot = free_slot();
    GrayView view;
    if (taken.image != nullptr) {
      const CameraParameters& expected = camera_.model.parameters();
      auto loaded =
          read_gray_image(taken.image->path, ImageSize{expected.width_px, expected.height_px});
      if (!loaded) {
        capture_->note_unusable(loaded.error());
        ++damaged_;
        take_back(slot);
        return std::nullopt;
      }
      images_[slot] = std::move(loaded->image);
      view = images_[slot].view();
    }
    return Frame(info, view, taken.detections, this, slot);
  }

  [[nodiscard]] std::uint32_t free_slot() {
    const std::lock_guard lock(mutex_);
    const auto free = std::find(lent_.begin(), lent_.end(), 0);
    const auto slot = static_cast<std::uint32_t>(free - lent_.begin());
    if (free == lent_.end()) {
      lent_.push_back(0);
      images_.emplace_back();
    }
    lent_[slot] = 1;
    return slot;
  }

  std::shared_ptr<ReplayCapture> capture_;
  const RigCamera& camera_;
  const std::vector<ReplayCapture::Entry>& entries_;
  std::size_t position_ = 0;  ///< rounds included
  std::uint64_t damaged_ = 0;
  std::mutex mutex_;  ///< of what stop() and take_back() touch
  std::condition_variable stopping_;
  bool stopped_ = false;
  std::vector<char> lent_;
  std::vector<GrayImage> images_;  ///< per slot; touched by next() only
};

Expected<std::shared_ptr<ReplayCapture>> ReplayCapture::open(const std::filesystem::path& folder,
                                                             const ReplayOptions& options) {
  auto opened = open_capture_folder(folder);
  if (!opened) return tl::make_unexpected(opened.error());
  std::shared_ptr<ReplayCapture> capture(new ReplayCapture);
  capture->folder_ = std::move(*opened);
  capture->options_ = options;
  if (options.detections && capture->folder_.detections_csv) {
    auto table = read_detections_csv(*capture->folder_.detections_csv, capture->folder_.rig,
                                     capture->folder_.catalog, capture->folder_.monotonic);
    if (!table) return tl::make_unexpected(table.error());
    static_cast<void>(widen_for_unknown_moves(*table, capture->folder_.rig));
    capture->detections_ = std::move(table->images);
  }
  if (auto filled = capture->fill_time_line(); !filled) {
    return tl::make_unexpected(filled.error());
  }
  return capture;
}

Status ReplayCapture::fill_time_line() {
  const std::string name = folder_.path.string();
  if (!folder_.stamps_from_names && folder_.rig.cameras.size() > 1) {
    return fail(ErrorKind::bad_data,
                "{}: the images' names are no stamps; several cameras can't "
                "be played without",
                name);
  }
  if (folder_.rig.cameras.size() > 1 && !folder_.rig.has_extrinsics) {
    return fail(ErrorKind::bad_data,
                "{}: rig.yaml has {} cameras without transforms between them; add T_cn_cnm1", name,
                folder_.rig.cameras.size());
  }
  std::vector<std::map<Stamp, Entry>> by_stamp(folder_.rig.cameras.size());
  const auto at = [&](int camera, Stamp stamp) -> Entry& {
    Entry& entry = by_stamp[static_cast<std::size_t>(camera)][stamp];
    entry.stamp = stamp;
    return entry;
  };
  if (options_.images) {
    for (const ImageFile& image : folder_.images) at(image.camera, image.stamp).image = &image;
  }

  for (const ImageDetections& found : detections_) {
    at(found.camera, found.stamp).detections = &found;
  }
  std::vector<Stamp> all;
  std::vector<StampedImage> stamped;
  entries_.resize(by_stamp.size());
  for (std::size_t c = 0; c < by_stamp.size(); ++c) {
    for (const auto& [stamp, entry] : by_stamp[c]) {
      entries_[c].push_back(entry);
      all.push_back(stamp);
      stamped.push_back({static_cast<int>(c), stamp});
    }
  }
  if (all.empty()) {
    return fail(ErrorKind::bad_data, "{}: neither images nor detections to play", name);
  }
  std::sort(all.begin(), all.end());
  first_ = all.front();
  // Images and detections each may, and both together not.
  if (const auto doubt = doubt_of_span(stamped)) {
    return fail(Cause::stamps, "{}: {}", name, *doubt);
  }
  auto usable = usable_tolerance(folder_.sync_tolerance, stamped, entries_.size());
  folder_.sync_tolerance = usable.tolerance;
  if (usable.note) {  // first: of very many only the first are shown
    folder_.notes.insert(folder_.notes.begin(), fmt::format("{}: {}", name, *usable.note));
  }
  std::vector<Stamp> periods = spacings_of(stamped);
  const Stamp period = periods.empty() ? std::chrono::milliseconds(100) : upper_median(periods);
  round_ = all.back() - first_ + period;
  return {};
}

std::size_t ReplayCapture::most_rounds() const {
  // From the last stamp on, whichever clock it is on: the largest one is never passed.
  const Stamp begun = std::max(Stamp{0}, first_ + shift());
  return std::max<std::size_t>(1, static_cast<std::size_t>((kLargestStamp - begun) / round_));
}

void ReplayCapture::note_unusable(const Error& why) {
  const std::lock_guard lock(mutex_);
  if (unusable_.images++ == 0) unusable_.first_reason = why.message;
}

ReplayCapture::Unusable ReplayCapture::unusable() const {
  const std::lock_guard lock(mutex_);
  return unusable_;
}

void ReplayCapture::begin_time_line() {
  std::call_once(begun_, [&] {
    if (options_.realtime) shift_ = monotonic_now() - first_;
  });
}

std::vector<std::unique_ptr<FrameSource>> ReplayCapture::sources(
    const std::shared_ptr<ReplayCapture>& capture) {
  std::vector<std::unique_ptr<FrameSource>> sources;
  for (std::size_t camera = 0; camera < capture->folder_.rig.cameras.size(); ++camera) {
    sources.push_back(std::make_unique<ReplaySource>(capture, camera));
  }
  return sources;
}

}  // namespace waymark
