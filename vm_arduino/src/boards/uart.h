// The serial port of the link: USART 0, without the core's `Serial`.
//
// The interrupt hands each byte to the firmware at once, so a stop never waits. A byte with a
// framing error counts as 0. If the line then stays low, each millisecond counts as another 0,
// because the UART reports a break only once.

#pragma once

#include <stdint.h>

#include "../link/port.h"

namespace tiniscript {

void uart_begin(uint32_t baud);

// Checks the line; call it once a millisecond.
void uart_tick();

// Starts to send the firmware's bytes, unless that is under way.
void uart_send();

LineErrors uart_errors();

}  // namespace tiniscript
