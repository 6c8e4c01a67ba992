#include "locd/record/own_folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <utility>

#include "core/base/system_call.h"

namespace waymark {

namespace fs = std::filesystem;

namespace {

/// What st_blocks counts, whatever the file system's blocks are.
constexpr std::uint64_t kStatBlock_bytes = 512;
constexpr unsigned kFacts = STATX_TYPE | STATX_NLINK | STATX_UID | STATX_BLOCKS | STATX_MNT_ID;

/// The file at `name`, or the open one itself when that is empty; false with errno.
bool ask(int descriptor, const std::string& name, struct statx& file) {
  const int flags = AT_SYMLINK_NOFOLLOW | AT_NO_AUTOMOUNT | (name.empty() ? AT_EMPTY_PATH : 0);
  return ::statx(descriptor, name.c_str(), flags, kFacts | STATX_INO, &file) == 0;
}

/// A folder of that name, no link and no mount; −1 with errno. Without openat2, which a unit with
/// RestrictSUIDSGID answers by ENOSYS: the name is one component, and mounts are told by their ids.
int open_within(int folder, const std::string& name) {
  struct statx parent {};
  struct statx child {};
  if (name.find('/') != std::string::npos || name == "..") return errno = EXDEV, -1;
  if (!ask(folder, "", parent) || !ask(folder, name, child)) return -1;
  if (S_ISLNK(child.stx_mode)) return errno = ELOOP, -1;
  const int opened =
      ::openat(folder, name.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (opened < 0) return -1;
  if (!ask(opened, "", child) || child.stx_mnt_id != parent.stx_mnt_id) {
    ::close(opened);
    return errno = EXDEV, -1;
  }
  return opened;
}

/// Why something can't be opened as what it should be.
std::string why_not_opened() {
  if (errno == ELOOP) return "it is a link";
  if (errno == EXDEV) return "something is mounted there";
  if (errno == ENOTDIR) return "it is no folder";
  if (errno == ENXIO) return "it is no regular file";
  return system_reason();
}

bool same_device(const struct statx& a, const struct statx& b) {
  return a.stx_dev_major == b.stx_dev_major && a.stx_dev_minor == b.stx_dev_minor;
}

}  // namespace

OwnFolder::OwnFolder(fs::path path, Descriptor descriptor, uid_t owner)
    : path_(std::move(path)),
      descriptor_(std::make_shared<const Descriptor>(std::move(descriptor))),
      owner_(owner) {}

Expected<OwnFolder> OwnFolder::open(const fs::path& path) {
  Descriptor folder(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.valid()) return OwnFolder(path, std::move(folder), ::geteuid());
  return fail(creation_error(), "{}: can't open: {}", path.string(), why_not_opened());
}

Expected<OwnFolder> OwnFolder::folder(const std::string& name) const {
  Descriptor folder(open_within(descriptor(), name));
  if (folder.valid()) return OwnFolder(path_ / name, std::move(folder), owner_);
  return fail(creation_error(), "{}: can't record here: {}", (path_ / name).string(),
              why_not_opened());
}

Expected<OwnFolder> OwnFolder::make_folder(const std::string& name) const {
  if (::mkdirat(descriptor(), name.c_str(), 0777) != 0 && errno != EEXIST) {
    return fail(creation_error(), "{}: can't create: {}", (path_ / name).string(), system_reason());
  }
  return folder(name);
}

std::string OwnFolder::why_not_own(const struct statx& file) const {
  struct statx here {};
  if (!ask(descriptor(), "", here)) return system_reason();
  if (S_ISLNK(file.stx_mode)) return "it is a link";
  if (!S_ISREG(file.stx_mode)) return "it is no regular file";
  if (!same_device(file, here) || file.stx_mnt_id != here.stx_mnt_id) {
    return "it is mounted there from elsewhere";
  }
  if (file.stx_uid != owner_) return fmt::format("it belongs to user {}", file.stx_uid);
  if (file.stx_nlink != 1) {
    return fmt::format("it has {} names, and the others would keep its room", file.stx_nlink);
  }
  return "";
}

Expected<std::uint64_t> OwnFolder::own_bytes(const std::string& name) const {
  struct statx file {};
  if (!ask(descriptor(), name, file)) {
    return fail(errno == ENOENT ? ErrorKind::no_input : ErrorKind::io, "{}: {}",
                (path_ / name).string(), system_reason());
  }
  if (const std::string why = why_not_own(file); !why.empty()) {
    return fail(ErrorKind::permission, "{}: {}", (path_ / name).string(), why);
  }
  return file.stx_blocks * kStatBlock_bytes;
}

Expected<std::uint64_t> OwnFolder::remove(const std::string& name) const {
  auto bytes = own_bytes(name);
  if (!bytes || ::unlinkat(descriptor(), name.c_str(), 0) == 0) return bytes;
  return fail(creation_error() == ErrorKind::permission ? ErrorKind::permission : ErrorKind::io,
              "{}: {}", (path_ / name).string(), system_reason());
}

void OwnFolder::remove_empty_folder(const std::string& name) const {
  ::unlinkat(descriptor(), name.c_str(), AT_REMOVEDIR);
}

Descriptor OwnFolder::create(const std::string& name) const {
  return Descriptor(::openat(descriptor(), name.c_str(),
                             O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
}

Expected<Descriptor> OwnFolder::open_to_append(const std::string& name) const {
  // Without waiting for whoever may read what turns out to be a pipe.
  constexpr int kFlags = O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  Descriptor file(::openat(descriptor(), name.c_str(), kFlags, 0666));
  if (!file.valid()) {
    return fail(creation_error(), "{}: can't create: {}", (path_ / name).string(),
                why_not_opened());
  }
  struct statx facts {};
  const std::string why = ask(file.get(), "", facts) ? why_not_own(facts) : system_reason();
  if (why.empty()) return file;
  return fail(ErrorKind::cant_create, "{}: can't write: {}", (path_ / name).string(), why);
}

std::string OwnFolder::read(const std::string& name) const {
  const Descriptor file(
      ::openat(descriptor(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct statx facts {};
  if (!file.valid() || !ask(file.get(), "", facts) || !S_ISREG(facts.stx_mode)) return "";
  std::array<char, 1 << 16> text{};
  const ssize_t got = ::read(file.get(), text.data(), text.size());
  return {text.data(), got > 0 ? static_cast<std::size_t>(got) : 0};
}

bool OwnFolder::rename(const std::string& from, const std::string& to) const {
  return ::renameat(descriptor(), from.c_str(), descriptor(), to.c_str()) == 0;
}

Status OwnFolder::check_writable(const std::string& name) const {
  const auto there = own_bytes(name);
  if (there || there.error().kind == ErrorKind::no_input) return {};
  return fail(ErrorKind::cant_create, "{}; can't write; name another folder",
              there.error().message);
}

void OwnFolder::each_name(const std::function<void(const std::string&)>& visit) const {
  const int listed = ::openat(descriptor(), ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(::fdopendir(listed), ::closedir);
  if (folder == nullptr) {
    if (listed >= 0) ::close(listed);
    return;
  }
  while (const dirent* const entry = ::readdir(folder.get())) {
    const std::string name = static_cast<const char*>(entry->d_name);
    if (name != "." && name != "..") visit(name);
  }
}

void OwnFolder::learn_owner(const std::string& name) {
  struct statx file {};
  if (ask(descriptor(), name, file)) owner_ = file.stx_uid;
}

bool OwnFolder::is_same_as(const OwnFolder& other) const {
  struct statx a {};
  struct statx b {};
  return ask(descriptor(), "", a) && ask(other.descriptor(), "", b) && same_device(a, b) &&
         a.stx_ino == b.stx_ino;
}

}  // namespace waymark
