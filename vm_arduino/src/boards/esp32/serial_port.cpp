// Bluetooth with a serial port (SPP), of an ESP32; its successors have none.
//
// The core's own task calls what is sent to the robot, and who connects and leaves; the task of this
// radio sends.

#ifdef ARDUINO_ARCH_ESP32

#include <Arduino.h>

#include "radio.h"

#ifdef CONFIG_BT_SPP_ENABLED
#include <BluetoothSerial.h>

namespace tiniscript {

namespace {

BluetoothSerial port;
bool has_client;  // the core's task

Pipe& pipe() { return radio_pipe(Transport::kSerialPort); }

// Of a second client, which the core sends away, the first one stays.
void on_event(esp_spp_cb_event_t, esp_spp_cb_param_t*) {
  const bool is_there = port.hasClient();
  if (is_there == has_client) return;
  has_client = is_there;
  if (is_there) {
    pipe().begin();
  } else {
    pipe().part();
  }
}

// In the place of the core's queue, which has 512 places and drops what finds none.
void on_data(const uint8_t* bytes, size_t length) {
  const uint16_t now_ms = static_cast<uint16_t>(millis());
  for (size_t k = 0; k < length; k++) pipe().put(bytes[k], now_ms);
}

}  // namespace

bool serial_port_begin() {
  port.register_callback(on_event);
  port.onData(on_data);
  return port.begin(radio_name().name);
}

// `write` waits while the peer takes nothing, up to a second: this task alone does.
void serial_port_turn() {
  uint8_t bytes[64];
  size_t length = 0;
  while (pipe().is_connected() && length < sizeof bytes && pipe().take(bytes + length)) length++;
  if (length != 0) port.write(bytes, length);
}

}  // namespace tiniscript

#else

namespace tiniscript {

bool serial_port_begin() { return false; }
void serial_port_turn() {}

}  // namespace tiniscript

#endif  // CONFIG_BT_SPP_ENABLED

#endif  // ARDUINO_ARCH_ESP32
