// Bluetooth with a serial port (SPP), of an ESP32; its successors have none.

#ifdef ARDUINO_ARCH_ESP32

#include <Arduino.h>

#include "radio.h"

#ifdef CONFIG_BT_SPP_ENABLED
#include <BluetoothSerial.h>

namespace tiniscript {

namespace {

BluetoothSerial port;
bool has_client;
Tally leavings;  // the core's task counts them

// Of a second client, which the core sends away, the first one stays.
void on_event(esp_spp_cb_event_t event, esp_spp_cb_param_t*) {
  if (event == ESP_SPP_CLOSE_EVT && !port.hasClient()) leavings.add();
}

}  // namespace

bool serial_port_begin() {
  port.register_callback(on_event);
  return port.begin(radio_name().name);
}

// `write` waits while the peer takes nothing, up to a second: this task alone does. The next client
// may be there by then; what it has sent is none of the one before.
void serial_port_turn() {
  Pipe& pipe = radio_pipe(Transport::kSerialPort);
  int left = port.available();
  const bool has_left = leavings.take();
  const bool is_there = port.hasClient();
  if (has_client && has_left && is_there) pipe.part();
  if (is_there && (has_left || !has_client)) pipe.begin();
  const uint16_t now_ms = static_cast<uint16_t>(millis());
  for (; left > 0; left--) pipe.put(static_cast<uint8_t>(port.read()), now_ms);
  if (!is_there && has_client) pipe.part();
  has_client = is_there;
  uint8_t bytes[64];
  size_t length = 0;
  while (is_there && length < sizeof bytes && pipe.take(bytes + length)) length++;
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
