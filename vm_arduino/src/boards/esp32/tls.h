// TLS over a socket that never waits, by the mbedTLS of ESP-IDF.
//
// One connection at a time. It takes memory from the heap while it lasts, as the radios do: without
// enough of it there is no connection. The calculations of a handshake keep its task busy.

#pragma once

#include "broker_settings.h"

namespace tiniscript {

constexpr int kNothingYet = 0;
constexpr int kEnded = -1;

// Begins a connection to the broker of `settings`, which stay where they are until `tls_end`.
// Returns kSearching, or the reason why there is none.
WifiState tls_begin(int socket, const BrokerSettings& settings);

// Goes on with the handshake by one step, after which its task is to pause: kSearching until it is
// kReady, or why it has failed.
WifiState tls_shake();

// The number of bytes that were there or found room, kNothingYet or kEnded. Unsent bytes must be
// the first of the next ones.
int tls_receive(uint8_t* bytes, size_t room);
int tls_send(const uint8_t* bytes, size_t length);

void tls_end();

}  // namespace tiniscript
