#pragma once

#include "core/base/error.h"

namespace waymark {

/// No answer came in time; asking again may help (EX_TEMPFAIL of sysexits). Apart from the other
/// kinds, for only who waits for another process or a disk has it.
inline constexpr auto kNoAnswer = static_cast<ErrorKind>(75);

}  // namespace waymark
