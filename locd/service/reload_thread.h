#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "core/base/error.h"
#include "locd/service/localization_thread.h"
#include "locd/service/setup.h"

namespace waymark {

/// What a reload swaps in: read, checked and built.
struct Replacement {
  Setup setup;
  MapInUse map;
  std::vector<QuarantinedMarker> quarantine;  ///< of that map, known already
};

/// Prepares reloads in a thread of its own, for a disk may stall. One is prepared at a time. When
/// another request comes meanwhile, the result is discarded and prepared again.
class ReloadThread {
 public:
  using Prepare = std::function<Expected<Replacement>()>;

  explicit ReloadThread(Prepare prepare) : prepare_(std::move(prepare)) {}
  /// Waits until nothing is being prepared.
  ~ReloadThread();
  ReloadThread(const ReloadThread&) = delete;
  ReloadThread& operator=(const ReloadThread&) = delete;

  void request();
  /// The result of the newest request, once; nullopt while one is being prepared.
  [[nodiscard]] std::optional<Expected<Replacement>> take();
  /// The same; false when something still is being prepared at `deadline`.
  [[nodiscard]] bool settle(Stamp deadline) const;

 private:
  void run();

  const Prepare prepare_;
  mutable std::mutex mutex_;  ///< of everything below
  mutable std::condition_variable changed_;
  bool requested_ = false;
  bool preparing_ = false;
  bool ending_ = false;
  std::optional<Expected<Replacement>> prepared_;
  std::thread thread_;
};

}  // namespace waymark
