// The connection to a broker as bytes: a socket that never waits, with TLS or without.
//
// One at a time, of the broker's task. Looking the broker's name up is all that waits.

#pragma once

#include "broker_settings.h"
#include "tls.h"

namespace tiniscript {

// Begins to connect to the broker of `settings`, which stay where they are until `line_end`.
// False: there is no socket.
bool line_begin(const BrokerSettings& settings);

// Goes on connecting: kSearching until it is kReady. kOff: the broker does not listen; others say
// why there is no TLS.
WifiState line_connect();

// The same as in `tls.h`.
int line_receive(uint8_t* bytes, size_t room);
int line_send(const uint8_t* bytes, size_t length);

void line_end();

}  // namespace tiniscript
