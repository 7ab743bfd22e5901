// The link over USB: UART 0, through the USB chip of the board.
//
// The driver of the core takes bytes in its interrupt, and the main loop hands them to the firmware
// in each turn, with those of the radios. A break of any length arrives as one byte 0, and is
// reported once: only its pin shows the level of the line meanwhile. On a board without a USB chip,
// `Serial` may be the USB of an ESP32-C3 itself.

#ifdef ARDUINO_ARCH_ESP32

#include <Arduino.h>
#include <driver/uart.h>
#include <soc/uart_reg.h>

#include "../../firmware/firmware.h"
#include "../kit.h"
#include "../uart.h"
#include "clock.h"
#include "events.h"
#include "pins.h"
#include "radio.h"

namespace tiniscript {

namespace {

constexpr size_t kRoomBytes = 1280;  // more than a computer may have under way

#ifdef CONFIG_IDF_TARGET_ESP32C3
constexpr Pin kReceive = {20};

#if defined(ARDUINO_USB_CDC_ON_BOOT) && ARDUINO_USB_CDC_ON_BOOT
constexpr bool is_usb(Pin pin) { return pin.number == 18 || pin.number == 19; }

static_assert(!is_usb(kBuzzer.pin) && !is_usb(kLight) && !is_usb(kStartButton),
              "Pins 18 and 19 are the USB of an ESP32-C3, and that is the port of this board: it would "
              "be gone. Take other pins, and make the header again with tsc firmware --board.");
#endif
#else
constexpr Pin kReceive = {3};
#endif

// A byte under way is over after so many milliseconds. A line that is low in all of them, with no byte
// received, is held low.
constexpr uint8_t kLowMs = static_cast<uint8_t>(10000 / kBaud + 3);

// The driver hands a byte over before so many, and reports its framing error at once.
constexpr uint8_t kFifoMs = static_cast<uint8_t>(128 * 10000 / kBaud + 1);

// The core's task counts, the main loop reads.
volatile uint8_t framing_errors;  // errors, and breaks
volatile uint8_t damaged_bytes;   // bytes with an error
volatile uint8_t overruns;

// The main loop's.
uint8_t taken_zeros;          // of the spoiled bytes, those that have counted as a zero
uint8_t waited_ms;            // for the first of the others
uint8_t seen_framing_errors;  // errors before the line was last seen high
uint8_t low_ms;               // since then, after an error and without a byte
bool was_high;                // since the reset or the last time the line was held low; else no sender

void on_error(hardwareSerial_error_t error) {
  switch (error) {
    case UART_FRAME_ERROR:
      damaged_bytes = static_cast<uint8_t>(damaged_bytes + 1);
      framing_errors = static_cast<uint8_t>(framing_errors + 1);
      return;
    case UART_BREAK_ERROR:
      framing_errors = static_cast<uint8_t>(framing_errors + 1);
      return;
    case UART_BUFFER_FULL_ERROR:
    case UART_FIFO_OVF_ERROR:
      overruns = static_cast<uint8_t>(overruns + 1);
      return;
    default:
      return;
  }
}

// Bytes to send wait only in its FIFO. With a ring, the core would always report room, and a byte
// without room would block the main loop.
// The driver tells no framing errors but breaks, until it is asked.
inline void begin_port(HardwareSerial& port, uint32_t baud) {
  port.onReceiveError(on_error);
  port.begin(baud);
  uart_enable_intr_mask(UART_NUM_0, UART_FRM_ERR_INT_ENA);
}

// The chip's own USB: it has no line errors, and must not wait without a reader.
template <class Port>
void begin_port(Port& port, uint32_t baud) {
  port.setTxBufferSize(kRoomBytes);
  port.setTxTimeoutMs(0);
  port.begin(baud);
}

void take(uint8_t byte) {
  firmware_on_rx_byte(Transport::kCable, byte, static_cast<uint16_t>(millis()));
}

// Each spoiled byte counts as a zero. The driver does not say which byte it is: the zero comes
// after the first byte that follows, so that no part of a line or frame with an error in it is
// executed.
void take_zeros() {
  waited_ms = 0;
  for (; taken_zeros != damaged_bytes; taken_zeros = static_cast<uint8_t>(taken_zeros + 1)) take(0);
}

// Every turn: a line with bytes on it is high in some of them.
void note_high() {
  if (!is_high(kReceive)) return;
  was_high = true;
  seen_framing_errors = framing_errors;
  low_ms = 0;
}

// Every millisecond. A line that is held low counts as zeros until these are a stop.
void look_at_line() {
  if (!was_high || framing_errors == seen_framing_errors || is_high(kReceive)) return;
  low_ms = static_cast<uint8_t>(low_ms + 1);
  if (low_ms <= kLowMs) return;
  take(0);
  if (low_ms == kLowMs + kStopZeros) was_high = false;
}

}  // namespace

void uart_begin(uint32_t baud) {
  Serial.setRxBufferSize(kRoomBytes);
  begin_port(Serial, baud);
}

void uart_tick() {
  if (taken_zeros != damaged_bytes && waited_ms++ == kFifoMs) take_zeros();
  look_at_line();
  radio_tick();
}

void poll_events() {
  note_high();
  for (int available_bytes = Serial.available(); available_bytes > 0; available_bytes--) {
    const uint8_t byte = static_cast<uint8_t>(Serial.read());
    low_ms = 0;
    take(byte);
    if (byte == 0 && taken_zeros != damaged_bytes)
      taken_zeros = static_cast<uint8_t>(taken_zeros + 1);  // it is one
    take_zeros();
  }
  radio_poll();
}

void uart_send() {
  uint8_t byte = 0;
  while (Serial.availableForWrite() > 0 && firmware_next_tx_byte(Transport::kCable, &byte)) {
    Serial.write(byte);
  }
  radio_send();
}

LineErrors uart_errors() { return {framing_errors, static_cast<uint8_t>(overruns + radio_lost())}; }

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
