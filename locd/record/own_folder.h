#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "core/base/descriptor.h"
#include "core/base/error.h"

struct statx;

namespace waymark {

/// A folder in which locd writes and deletes, and the one place that decides what it may delete:
/// regular files of its own user, with one name, on the folder's own mount. Everything is named by
/// its last part below a descriptor, so no link is followed and no mount is crossed, whatever
/// others rename meanwhile. A handle: copies are of the same folder.
class OwnFolder {
 public:
  /// Opens a folder by its path, which may lead over links: whoever configures locd has named it.
  /// Errors: cant_create, permission.
  [[nodiscard]] static Expected<OwnFolder> open(const std::filesystem::path& path);

  /// The folder `name` in it. Errors: cant_create for a link, a mount, or no folder at all;
  /// permission.
  [[nodiscard]] Expected<OwnFolder> folder(const std::string& name) const;
  /// The same, made where it is absent.
  [[nodiscard]] Expected<OwnFolder> make_folder(const std::string& name) const;

  /// What deleting the file gives back: its blocks, in bytes. Errors: no_input when it is absent,
  /// permission when it is not locd's own to delete, with the reason.
  [[nodiscard]] Expected<std::uint64_t> own_bytes(const std::string& name) const;
  /// Deletes the file; gives what that gave back. Errors: those of own_bytes; io, permission.
  Expected<std::uint64_t> remove(const std::string& name) const;
  /// Deletes the folder `name` where nothing is left in it.
  void remove_empty_folder(const std::string& name) const;

  /// A new file, to write. Invalid, with errno, when something is there already.
  [[nodiscard]] Descriptor create(const std::string& name) const;
  /// A file to append to, created where absent. Errors: cant_create for what is not locd's own;
  /// permission, io.
  [[nodiscard]] Expected<Descriptor> open_to_append(const std::string& name) const;
  /// The beginning of a regular file, whoever owns it; empty when it can't be read.
  [[nodiscard]] std::string read(const std::string& name) const;
  /// `from` takes the place of `to`; false with errno.
  [[nodiscard]] bool rename(const std::string& from, const std::string& to) const;
  /// Cause to refuse to write the file `name`: something is there that is not locd's own.
  [[nodiscard]] Status check_writable(const std::string& name) const;

  /// Calls `visit` with the names of what is in it, as far as they can be listed.
  void each_name(const std::function<void(const std::string&)>& visit) const;

  /// Whose files are locd's own from now on: the owner of a file that locd has just made there. On
  /// disks without owners it is not locd's user.
  void learn_owner(const std::string& name);

  void take_owner_of(const OwnFolder& other) { owner_ = other.owner_; }

  [[nodiscard]] bool is_same_as(const OwnFolder& other) const;
  [[nodiscard]] int descriptor() const { return descriptor_->get(); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  OwnFolder(std::filesystem::path path, Descriptor descriptor, uid_t owner);
  /// Why a file is not locd's own; empty when it is.
  [[nodiscard]] std::string why_not_own(const struct statx& file) const;

  std::filesystem::path path_;
  std::shared_ptr<const Descriptor> descriptor_;
  uid_t owner_;
};

}  // namespace waymark
