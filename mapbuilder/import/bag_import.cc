#include "mapbuilder/import/bag_import.h"

#include <fmt/ostream.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/base/growing_folder.h"
#include "core/camera/kalibr.h"
#include "mapbuilder/import/bag_images.h"
#include "mapbuilder/import/ros_rig.h"
#include "mapbuilder/import/rosbag2.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;

/// Turns one recording into one folder, step by step.
class BagImport {
 public:
  BagImport(const BagImportOptions& options, const fs::path& folder)
      : options_(options), folder_(folder), images_(folder, options.topics, options.every) {}

  Status read(Progress& progress) {
    const auto files = files_of_recording(options_.bag);
    if (!files) return tl::make_unexpected(files.error());
    for (const fs::path& file : *files) {
      if (auto read = read_file(file, progress); !read) return read;
    }
    return {};
  }

  /// Gives each topic its place as a camera.
  Status place_cameras() {
    if (auto chosen = choose(); !chosen) return chosen;
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
      const TopicImages& images = *cameras_[i];
      std::error_code failed;
      fs::rename(images.folder, folder_ / fmt::format("cam{}", i), failed);
      if (failed) {
        return fail(ErrorKind::io, "{}: can't move: {}", images.folder.string(), failed.message());
      }
    }
    return {};
  }

  Status describe() {
    if (auto fits = check_rig(); !fits) return fits;
    if (auto copied = describe_capture(options_.description, folder_); !copied) return copied;
    const std::string clock = counts_from_epoch() ? "realtime" : "monotonic";
    if (auto written =
            write_new_file(folder_ / "capture.toml", fmt::format("clock = \"{}\"\n", clock));
        !written) {
      return written;
    }
    return options_.description.rig ? Status{} : describe_lenses();
  }

  void tell(std::ostream& out, std::ostream& notes) const {
    for (std::size_t i = 0; i < cameras_.size(); ++i) tell_camera(i, out, notes);
    for (const std::string& note : notes_) fmt::print(notes, "note: {}\n", in_one_line(note));
    fmt::print(out, "{}: {} images of {} cameras\n", in_one_line(options_.output.string()),
               images_.written(), cameras_.size());
    tell_what_is_missing(options_.output, notes);
  }

 private:
  Status read_file(const fs::path& file, Progress& progress) {
    constexpr std::uintmax_t kMegabyte = 1'000'000;
    const auto bag =
        open_recorded(file, [this](const BagTopic& topic) { return images_.wants(topic); });
    if (!bag) return tl::make_unexpected(bag.error());
    std::error_code absent;
    const std::uintmax_t bytes = fs::file_size(file, absent);
    progress.begin(fmt::format("reading {}, MB", in_one_line(file.filename().string())),
                   absent ? 0 : bytes / kMegabyte);
    for (;;) {
      const auto message = (*bag)->next();
      if (!message) return tl::make_unexpected(message.error());
      if (!*message) break;
      if (auto taken = images_.take(**message); !taken) {
        return fail(taken.error().kind, "{}: {}", file.string(), taken.error().message);
      }
      progress.update((*bag)->position() / kMegabyte, fmt::format("{} images", images_.written()));
    }
    progress.end();
    return {};
  }

  Status choose() {
    std::vector<std::string> names = options_.topics;
    if (names.empty()) {
      for (const auto& [name, images] : images_.topics()) names.push_back(name);
    }
    if (names.empty()) return no_images();
    for (const std::string& name : names) {
      const auto found = images_.topics().find(name);
      if (found == images_.topics().end()) {
        return fail(ErrorKind::bad_data, "{}: no images of topic {}{}", options_.bag.string(), name,
                    others());
      }
      if (found->second.written == 0) {
        return fail(ErrorKind::bad_data, "{}: none of {} images of {} can be read; the first: {}",
                    options_.bag.string(), found->second.seen, name,
                    found->second.first_unreadable);
      }
      cameras_.push_back(&found->second);
    }
    return {};
  }

  [[nodiscard]] std::string others() const {
    return images_.others().empty()
               ? std::string()
               : fmt::format("; other topics: {}", fmt::join(images_.others(), ", "));
  }

  [[nodiscard]] Status no_images() const {
    return fail(ErrorKind::bad_data,
                "{}: no images in it (sensor_msgs/msg/Image or CompressedImage){}",
                options_.bag.string(), others());
  }

  /// A rig file that was named must be of these cameras.
  Status check_rig() const {
    if (!options_.description.rig) return {};
    const std::string name = options_.description.rig->string();
    const auto loaded = read_camchain(*options_.description.rig);
    if (!loaded) return tl::make_unexpected(loaded.error());
    const auto& cameras = loaded->rig.cameras;
    if (cameras.size() != cameras_.size()) {
      return fail(ErrorKind::bad_data,
                  "{}: {} cameras, but {} topics of images; name them by --camera, cam0's first",
                  name, cameras.size(), cameras_.size());
    }
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      const CameraParameters& p = cameras[i].model.parameters();
      if (ImageSize{p.width_px, p.height_px} == *cameras_[i]->size) continue;
      return fail(ErrorKind::bad_data, "{}: cam{} has {}×{} px, images of {} have {}×{}", name, i,
                  p.width_px, p.height_px, cameras_[i]->topic, cameras_[i]->size->width_px,
                  cameras_[i]->size->height_px);
    }
    return {};
  }

  /// Smaller stamps are of a simulator, or count from a machine's start.
  [[nodiscard]] bool counts_from_epoch() const {
    constexpr Stamp kFirstRecordings = std::chrono::seconds(946'684'800);  // the year 2000
    return std::all_of(cameras_.begin(), cameras_.end(), [&](const TopicImages* images) {
      return images->earliest >= kFirstRecordings;
    });
  }

  /// rig.yaml of the cameras' camera_info; where that can't be, a note says why.
  Status describe_lenses() {
    std::vector<RecordedLens> lenses;
    for (const TopicImages* images : cameras_) {
      auto lens = lens_of(*images);
      if (!lens) {
        notes_.push_back(lens.error().message);
        return {};
      }
      lenses.push_back(std::move(*lens));
    }
    const auto loaded = rig_of_lenses(lenses);
    if (!loaded) {
      notes_.push_back(loaded.error().message + "; no rig.yaml is made of it");
      return {};
    }
    if (cameras_.size() > 1) {
      notes_.push_back(
          "rig.yaml is made of camera_info, which does not say how cameras stand to each other: "
          "build with --mono, or let mapbuilder calibrate find it");
    }
    return write_new_file(folder_ / "rig.yaml", format_camchain(loaded->rig));
  }

  [[nodiscard]] Expected<RecordedLens> lens_of(const TopicImages& images) const {
    const auto& infos = images_.camera_infos();
    for (const std::string& topic : camera_info_topics(images.topic)) {
      const auto found = infos.find(topic);
      if (found == infos.end()) continue;
      const RosCameraInfo& info = found->second;
      if (ImageSize{info.width_px, info.height_px} != *images.size) {
        return fail(ErrorKind::bad_data, "{}: of {}×{} px, images of {} have {}×{}; not used",
                    topic, info.width_px, info.height_px, images.topic, images.size->width_px,
                    images.size->height_px);
      }
      return RecordedLens{topic, info, is_rectified_topic(images.topic)};
    }
    return fail(ErrorKind::bad_data, "{}: no camera_info beside it", images.topic);
  }

  void tell_camera(std::size_t camera, std::ostream& out, std::ostream& notes) const {
    const TopicImages& images = *cameras_[camera];
    const std::string topic = in_one_line(images.topic);
    fmt::print(out, "{} became cam{}: {} images of {}×{} px, {}\n", topic, camera, images.written,
               images.size->width_px, images.size->height_px, in_one_line(images.form));
    if (images.same_stamp > 0) {
      fmt::print(notes, "note: {}: {} images left out, their header.stamp was there before\n",
                 topic, images.same_stamp);
    }
    if (images.unreadable > 0) {
      fmt::print(notes, "note: {}: {} images left out; the first: {}\n", topic, images.unreadable,
                 images.first_unreadable);
    }
  }

  const BagImportOptions& options_;
  const fs::path& folder_;
  BagImages images_;
  std::vector<const TopicImages*> cameras_;  ///< cam0's first
  std::vector<std::string> notes_;
};

}  // namespace

Status import_bag(const BagImportOptions& options, Progress& progress, std::ostream& out,
                  std::ostream& notes) {
  if (auto fine = RangeCheck().field("--every", options.every, BagImportOptions::kEvery).status();
      !fine) {
    return fine;
  }
  auto folder = GrowingFolder::begin(options.output);
  if (!folder) return tl::make_unexpected(folder.error());
  BagImport import(options, folder->path());
  Status done = import.read(progress);
  if (done) done = import.place_cameras();
  if (done) done = import.describe();
  if (done) done = folder->finish();
  if (done) import.tell(out, notes);
  return done;
}

}  // namespace waymark
