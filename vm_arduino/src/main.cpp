// setup() and loop(): the firmware on its board.
//
// The board tells the firmware of its button, its radio module and the time; the firmware asks the
// board for motors, sensors and light (`firmware/board.h`, `robot.h`). Bytes of the link go through
// interrupts: `boards/uart.cpp` calls `firmware_on_rx_byte` and `firmware_next_tx_byte`.
//
// Empty where there is no Arduino: a build for a computer may take all of this folder.

#ifdef ARDUINO

#include <Arduino.h>  // declares setup() and loop()

#include "boards/board.h"
#include "boards/kit.h"
#include "boards/uart.h"
#include "firmware/firmware.h"

using namespace tiniscript;

void setup() {
  board_begin();
  firmware_begin(board_told());
  uart_begin(kBaud);
}

void loop() {
  const uint32_t now_ms = board_now_ms();
  board_tick(now_ms);
  const Press press = board_button(now_ms);
  if (press == Press::kPressed) firmware_on_pressed();
  if (press == Press::kHeld) firmware_on_held();
  if (press == Press::kReleased) firmware_on_released();
  if (board_has_disconnected()) firmware_on_disconnect();
  firmware_tick(now_ms);
  uart_tick();
}

#endif  // ARDUINO
