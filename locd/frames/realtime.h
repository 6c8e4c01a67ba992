#pragma once

#include <cstddef>
#include <string>

#include "core/base/error.h"

namespace waymark {

/// Names the calling thread, for top, ps and debuggers; 15 letters are kept.
void name_thread(const std::string& name);

/// Priorities on SCHED_FIFO: frames are taken before they are localized. The kernel's own threads
/// for interrupts run at 50.
inline constexpr int kCapturePriority = 40;
inline constexpr int kLocalizationPriority = 30;

/// Puts the calling thread on SCHED_FIFO (1–99). config, with what to install, when the system does
/// not permit it.
[[nodiscard]] Status make_realtime(int priority);

/// Keeps all memory that is touched from now on in RAM. config, with what to set, when the system
/// does not permit it.
[[nodiscard]] Status lock_memory();

/// Has the allocator keep what it once took, in one heap, and gives that heap `reserve_bytes` at
/// once: no page comes or goes later, and the resident memory stands still. For a program whose
/// needs repeat; before its threads start.
void keep_heap(std::size_t reserve_bytes);

/// Whether threads may be put on SCHED_FIFO: tries it in one of its own.
[[nodiscard]] Status check_realtime();

}  // namespace waymark
