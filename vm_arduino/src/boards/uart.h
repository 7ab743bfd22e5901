// The serial port that the link goes over: USART 0, without the core's `Serial`.
//
// What arrives goes to the firmware in the interrupt: so a stop is never behind anything. A byte
// with a framing error counts as 0. A line that stays low after one counts as a 0 each millisecond,
// for the UART itself tells a break only once.

#ifndef TINISCRIPT_BOARDS_UART_H_
#define TINISCRIPT_BOARDS_UART_H_

#include <stdint.h>

#include "../link/port.h"

namespace tiniscript {

void uart_begin(uint32_t baud);

// Sends what the firmware has to say, as far as it is not being sent.
void uart_tick();

LineErrors uart_errors();

}  // namespace tiniscript

#endif  // TINISCRIPT_BOARDS_UART_H_
