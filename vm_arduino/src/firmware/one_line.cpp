// The bytes of a robot that is reached over one line.

#include "one_line.h"

#include "../vm/build.h"
#include "../vm/small.h"
#include "firmware.h"
#include "state.h"

#ifndef tiniscript_transports

namespace tiniscript {

Receiver receiver;

void begin_link(uint8_t epoch) { link.begin(&receiver, epoch); }

void firmware_on_rx_byte(uint8_t byte, uint16_t time_ms) {
  // The call keeps no values, so that no register must be saved before it.
  if (near(&receiver)->count_zeros(byte, time_ms)) {
    board_stop();
    return near(&receiver)->keep_last_zero();
  }
  firmware_take_rx_byte(byte, time_ms);
}

void firmware_take_rx_byte(uint8_t byte, uint16_t time_ms) {
  if (near(&receiver)->keep_and_find_stop(byte, time_ms)) board_stop();
}

bool firmware_has_tx_byte() { return link.has_tx_byte(); }

bool firmware_next_tx_byte(uint8_t* byte) { return link.next_tx_byte(byte); }

}  // namespace tiniscript

#endif
