// Sockets of lwIP that never block, and their results when there is no data yet.

#pragma once

#include <lwip/sockets.h>
#if __has_include(<errno.h>)
#include <errno.h>
#endif

namespace tiniscript {

constexpr int kNoSocket = -1;

// Whether the failed operation may succeed later.
inline bool may_come_later() { return errno == EAGAIN || errno == EWOULDBLOCK; }

}  // namespace tiniscript
