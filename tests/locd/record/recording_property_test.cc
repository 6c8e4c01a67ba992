// Rings of recordings in random trees: with links, second names, mounts, other owners, sparse
// files, other programs' files and clocks that are wrong. Nothing outside a recording is ever
// touched, and nothing is deleted for nothing.
#include <sys/stat.h>
#include <unistd.h>

#include <map>
#include <random>
#include <set>

#include "tests/locd/record/recording_fixture.h"
#include "tests/support/disk_double.h"
#include "tests/support/mount_namespace.h"
#include "tests/support/temporary_folder.h"

namespace waymark {
namespace {

namespace fs = std::filesystem;
using std::chrono::hours;
using std::chrono::seconds;
using test::facts;
using test::kStart;
using test::set_at;

constexpr Stamp kClocks[] = {seconds(1000), kStart, kStart + hours(10), seconds(2'060'000'000)};

/// What a path stands for: not the name, the thing.
struct Thing {
  ino_t inode = 0;
  dev_t device = 0;
  mode_t mode = 0;
  off_t size = 0;
  auto operator<=>(const Thing&) const = default;
};

Thing thing_at(const fs::path& path) {
  struct stat file {};
  if (::lstat(path.c_str(), &file) != 0) return {};
  const bool is_file = S_ISREG(file.st_mode);
  return {file.st_ino, file.st_dev, file.st_mode, is_file ? file.st_size : 0};
}

class RandomTree {
 public:
  RandomTree(unsigned seed, bool mounts) : random_(seed), mounts_(mounts) {
    fs::create_directories(outside());
    fs::create_directories(archive());
    for (int r = 0; r < 4; ++r) make_recording(r);
    for (int i = roll(8); i > 0; --i) spoil();
    recordings_ = 4;
    note_what_is_not_ours();
  }

  [[nodiscard]] fs::path archive() const { return tmp_.path() / "archive"; }
  [[nodiscard]] fs::path outside() const { return tmp_.path() / "outside"; }
  [[nodiscard]] int roll(int below) { return static_cast<int>(random_() % below); }
  [[nodiscard]] Stamp clock() { return kClocks[roll(4)]; }

  /// On the disk, of all that locd may delete.
  [[nodiscard]] std::uint64_t own_bytes() const { return own_bytes_in(archive()); }
  /// What is free on a disk of `capacity`: what has another name outside is not given back.
  [[nodiscard]] std::uint64_t free_of(std::uint64_t capacity) const {
    std::map<Thing, std::uint64_t> bytes;
    for (const fs::path& folder : {archive(), outside()}) {
      for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        struct stat file {};
        if (::lstat(entry.path().c_str(), &file) == 0 && S_ISREG(file.st_mode)) {
          bytes[thing_at(entry.path())] = static_cast<std::uint64_t>(file.st_blocks) * 512;
        }
      }
    }
    std::uint64_t used = 0;
    for (const auto& [thing, size] : bytes) used += size;
    return capacity - std::min(capacity, used);
  }

  /// What was not locd's is as it was.
  void expect_untouched() const {
    for (const auto& [path, thing] : not_ours_) {
      EXPECT_EQ(thing_at(path), thing) << path << " is touched";
    }
  }

 private:
  void make_recording(int r) {
    const fs::path path = archive() / std::to_string(r);
    RecordingFacts f = facts();
    f.codec = roll(2) == 0 ? "pgm" : "jpeg";
    f.date_known = roll(2) == 0;
    auto folder = test::open_folder(path, f, test::generous());
    ASSERT_TRUE(folder);
    const Stamp start = clock() + hours(r);
    for (int i = 1 + roll(5); i > 0; --i)
      ASSERT_TRUE(folder->write_set(set_at(start + seconds(i))));
  }

  [[nodiscard]] fs::path any_recording() { return archive() / std::to_string(roll(4)); }
  [[nodiscard]] fs::path any_camera() { return any_recording() / (roll(2) == 0 ? "cam0" : "cam1"); }
  [[nodiscard]] fs::path any_image() {
    std::vector<fs::path> images;
    for (const auto& entry : fs::directory_iterator(any_camera())) images.push_back(entry.path());
    std::sort(images.begin(), images.end());
    return images.empty() ? outside() : images[random_() % images.size()];
  }
  /// A file, or a folder with an image, outside.
  [[nodiscard]] fs::path another_file() {
    return tmp_.write(fmt::format("outside/{}.pgm", ++others_), std::string(5000, 'o'));
  }
  [[nodiscard]] fs::path another_folder() {
    return tmp_.write(fmt::format("outside/{}/7.pgm", ++others_), std::string(5000, 'o'))
        .parent_path();
  }

  void spoil() {
    const fs::path image = any_image();
    if (!fs::is_regular_file(fs::symlink_status(image))) return;
    std::error_code ignored;
    switch (roll(12)) {
      case 0:
        return fs::create_hard_link(image, outside() / std::to_string(++others_), ignored);
      case 1:
        fs::remove(image);
        return fs::create_symlink(another_file(), image);
      case 2:
        return fs::resize_file(image, std::uintmax_t{1} << 40, ignored);
      case 3:
        EXPECT_TRUE(::geteuid() != 0 || ::chown(image.c_str(), 12345, 12345) == 0);
        return;
      case 4: {
        const fs::path camera = image.parent_path();
        fs::rename(camera, outside() / std::to_string(++others_), ignored);
        return fs::create_directory_symlink(another_folder(), camera, ignored);
      }
      case 5:
        if (mounts_) mounted_.emplace_back(another_folder(), image.parent_path());
        return;
      case 6:
        if (mounts_) mounted_.emplace_back(another_file(), image);
        return;
      case 7:
        tmp_.write(fs::relative(image.parent_path() / "notes.txt", tmp_.path()), "ours");
        return;
      case 8:
        ::mkfifo((image.parent_path() / "5.pgm").c_str(), 0600);
        return;
      case 9:
        tmp_.write(fs::relative(image.parent_path().parent_path() / "capture.toml", tmp_.path()),
                   "software = \"their recorder\"\n");
        return;
      case 10:
        tmp_.write(fs::relative(image.parent_path() / ".6.pgm.part", tmp_.path()), "half");
        return;
      default:
        return fs::create_directory_symlink(another_folder(), archive() / "link", ignored);
    }
  }

  /// By rules written down a second time: a path without links and mounts to a regular file of ours
  /// with one name, named as locd names it, in a recording of locd's.
  [[nodiscard]] bool is_ours(const fs::path& path) const {
    struct stat file {};
    if (::lstat(path.c_str(), &file) != 0 || !S_ISREG(file.st_mode) || file.st_nlink != 1) {
      return false;
    }
    if (file.st_uid != ::geteuid()) return false;
    const fs::path relative = fs::relative(path, archive());
    fs::path folder = archive();
    for (const fs::path& part : relative) {
      folder /= part;
      if (fs::is_symlink(folder) || is_mounted(folder)) return false;
    }
    const fs::path recording = archive() / *relative.begin();
    std::ifstream toml(recording / "capture.toml");
    const std::string text{std::istreambuf_iterator<char>(toml), {}};
    if (text.find("software = \"waymark locd ") == std::string::npos) return false;
    const std::string name = path.filename().string();
    const auto parts = std::distance(relative.begin(), relative.end());
    static const std::set<std::string> kTexts = {"capture.toml", "rig.yaml", "markers.toml",
                                                 "frames.csv"};
    if (parts == 2) return kTexts.contains(name);
    const std::string ending = path.extension().string();
    const bool image = (ending == ".pgm" || ending == ".jpg") &&
                       path.stem().string().find_first_not_of("0123456789") == std::string::npos;
    return parts == 3 && (image || name == ".6.pgm.part");
  }
  [[nodiscard]] bool is_mounted(const fs::path& path) const {
    return std::any_of(mounted_.begin(), mounted_.end(),
                       [&](const test::BindMount& mount) { return mount.place() == path; });
  }
  [[nodiscard]] std::uint64_t own_bytes_in(const fs::path& folder) const {
    std::uint64_t bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      struct stat file {};
      if (is_ours(entry.path()) && ::lstat(entry.path().c_str(), &file) == 0) {
        bytes += static_cast<std::uint64_t>(file.st_blocks) * 512;
      }
    }
    return bytes;
  }
  void note_what_is_not_ours() {
    for (const fs::path& folder : {archive(), outside()}) {
      for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const bool outside_of_it = folder == outside();
        if (!outside_of_it && (entry.is_directory() && !entry.is_symlink())) continue;
        if (outside_of_it || !is_ours(entry.path())) {
          not_ours_[entry.path()] = thing_at(entry.path());
        }
      }
    }
  }

  TemporaryFolder tmp_;
  std::mt19937 random_;
  bool mounts_;
  int others_ = 0;
  int recordings_ = 0;
  std::vector<test::BindMount> mounted_;
  std::map<fs::path, Thing> not_ours_;
};

TEST(RecordingProperty, NothingOutsideARecordingIsTouchedAndNothingIsDeletedForNothing) {
  const bool mounts = test::enter_mount_namespace();
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(fmt::format("seed {}{}", seed, mounts ? "" : ", without mounts"));
    test::DiskDouble disk;
    disk.bring_nothing();
    RandomTree tree(seed, mounts);
    const std::uint64_t capacity =
        (std::uint64_t{1} << 41) + test::set_bytes() * static_cast<std::uint64_t>(tree.roll(40));
    disk.say_free([&] { return tree.free_of(capacity); });
    RecordingFacts f = facts();
    f.archive = tree.archive();
    f.date_known = tree.roll(2) == 0;
    RecordingBudget budget;
    budget.max_bytes = test::set_bytes() * static_cast<std::uint64_t>(1 + tree.roll(30));
    budget.keep = hours(1 + tree.roll(20));
    const bool tight = tree.roll(2) == 0;
    budget.min_free_bytes = tight ? tree.free_of(capacity) - test::set_bytes() * 3 : 0;
    const fs::path path = tree.archive() / (tree.roll(2) == 0 ? "new" : "0");
    auto folder = test::open_folder(path, f, budget);
    tree.expect_untouched();
    if (!folder) continue;  // links and mounts where it would record
    const Stamp start = tree.clock() + hours(5);
    for (int i = 0; i < 12; ++i) {
      const std::uint64_t before = tree.own_bytes();
      const std::uint64_t free_before = tree.free_of(capacity);
      const auto written = folder->write_set(set_at(start + seconds(i)));
      const std::uint64_t after = tree.own_bytes();
      const std::uint64_t added = written && *written ? test::set_bytes() : 0;
      const std::uint64_t deleted = before + added - std::min(before + added, after);
      // Two sets, and what is left of a recording with its last.
      EXPECT_LE(deleted, 2 * test::set_bytes() + 8 * 4096) << "with set " << i;
      const bool too_much = before + test::set_bytes() + 8192 > budget.max_bytes;
      const bool too_full = free_before < budget.min_free_bytes + test::set_bytes() + 8192;
      if (!f.date_known && !too_much && !too_full) {
        // The table may have been rewritten.
        EXPECT_LE(deleted, 4096U) << "with set " << i << " for nothing";
      }
      tree.expect_untouched();
      if (!written) break;
    }
    if (testing::Test::HasFailure()) break;
  }
}

}  // namespace
}  // namespace waymark
