// setup() and loop(): the firmware on its board.
//
// The board passes button, radio module and time to the firmware; the firmware controls motors,
// sensors and light of the board (`firmware/board.h`, `robot.h`). Interrupts carry the bytes of the
// link: the chip's `uart.cpp` calls `firmware_on_rx_byte`, or `firmware_take_rx_byte` where its
// interrupt has looked for a stop itself, and does what `firmware_next_tx_byte` does.
//
// Empty without Arduino, so that a build for a computer may take this whole folder.

#ifdef ARDUINO

#include <Arduino.h>  // declares setup() and loop()

#include "boards/board.h"
#include "boards/chip.h"
#include "boards/kit.h"
#include "boards/uart.h"
#include "firmware/firmware.h"

using namespace tiniscript;

void setup() {
  board_begin();
  firmware_begin(board_boot_info());
  uart_begin(kBaud);
}

namespace {

// The work for each millisecond and each move of the button; skipping it makes other turns quicker.
// The end of a run that a LIVE replaces is sent a millisecond later.
void tick_board() {
  const uint32_t now_ms = board_now_ms();
  board_tick(now_ms);
  uart_tick();
  const Press press = board_button(now_ms);
  if (press == Press::kPressed) firmware_on_pressed();
  if (press == Press::kDown) firmware_on_down();
  if (press == Press::kReleased) firmware_on_released();
  if (firmware_has_due_live()) return;
  if (board_has_disconnected()) firmware_on_disconnect();
  firmware_on_time(now_ms);
}

}  // namespace

void loop() {
  poll_events();
  if (!firmware_has_due_live() && board_has_news()) tick_board();
  firmware_turn();
  uart_send();
}

#endif  // ARDUINO
