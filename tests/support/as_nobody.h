#pragma once

#include <unistd.h>

namespace waymark::test {

/// While it lives, this process is of a user to whom permissions apply, also where it was started
/// by the superuser.
class AsNobody {
 public:
  AsNobody() : before_(::geteuid()) {
    constexpr uid_t kNobody = 65534;
    applies_ = before_ != 0 || ::seteuid(kNobody) == 0;
  }
  AsNobody(const AsNobody&) = delete;
  AsNobody& operator=(const AsNobody&) = delete;
  ~AsNobody() {
    if (before_ == 0) static_cast<void>(::seteuid(before_));
  }
  /// False where the system does not let it.
  [[nodiscard]] bool applies() const { return applies_; }

 private:
  uid_t before_;
  bool applies_;
};

}  // namespace waymark::test
