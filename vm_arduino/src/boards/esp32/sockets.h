// Sockets of lwIP that never wait, and what they say when there is nothing to do yet.

#pragma once

#include <lwip/sockets.h>
#if __has_include(<errno.h>)
#include <errno.h>
#endif

namespace tiniscript {

constexpr int kNoSocket = -1;

// Whether what has just failed may be done later.
inline bool may_come_later() { return errno == EAGAIN || errno == EWOULDBLOCK; }

}  // namespace tiniscript
