// The link over USB: UART 0, behind the USB chip of the board.
//
// The driver of the core takes bytes in its interrupt, and the main loop hands them to the firmware
// in each turn, with those of the radios. A break comes as a byte 0. Where a board has no USB chip,
// `Serial` may be the USB of an ESP32-C3 itself.

#ifdef ARDUINO_ARCH_ESP32

#include <Arduino.h>

#include "../../firmware/firmware.h"
#include "../uart.h"
#include "attention.h"
#include "clock.h"
#include "radio.h"

namespace tiniscript {

namespace {

constexpr size_t kRoomBytes = 1280;  // what a computer may have under way, and more

// The core's task counts, the main loop reads.
volatile uint8_t framing;
volatile uint8_t overrun;

void on_error(hardwareSerial_error_t error) {
  switch (error) {
    case UART_BREAK_ERROR:
    case UART_FRAME_ERROR:
      framing = static_cast<uint8_t>(framing + 1);
      return;
    case UART_BUFFER_FULL_ERROR:
    case UART_FIFO_OVF_ERROR:
      overrun = static_cast<uint8_t>(overrun + 1);
      return;
    default:
      return;
  }
}

// What is sent waits in its FIFO alone. Behind a ring the core would always say that there is room,
// and a byte without room would make the main loop wait.
inline void begin_port(HardwareSerial& port) { port.onReceiveError(on_error); }

// The chip's own USB: it knows no errors of a line, and must not wait where nobody reads.
template <class Port>
void begin_port(Port& port) {
  port.setTxBufferSize(kRoomBytes);
  port.setTxTimeoutMs(0);
}

}  // namespace

void uart_begin(uint32_t baud) {
  Serial.setRxBufferSize(kRoomBytes);
  begin_port(Serial);
  Serial.begin(baud);
}

void uart_tick() { radio_tick(); }

void pay_attention() {
  for (int left = Serial.available(); left > 0; left--) {
    firmware_on_rx_byte(Transport::kCable, static_cast<uint8_t>(Serial.read()),
                        static_cast<uint16_t>(millis()));
  }
  radio_attend();
}

void uart_send() {
  uint8_t byte = 0;
  while (Serial.availableForWrite() > 0 && firmware_next_tx_byte(Transport::kCable, &byte)) {
    Serial.write(byte);
  }
  radio_send();
}

LineErrors uart_errors() { return {framing, static_cast<uint8_t>(overrun + radio_lost())}; }

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
