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

}  // namespace

bool serial_port_begin() { return port.begin(radio_name().name); }

// `write` waits while the peer takes nothing: this task alone does.
void serial_port_turn() {
  Pipe& pipe = radio_pipe(Transport::kSerialPort);
  const bool is_there = port.hasClient();
  if (is_there && !has_client) pipe.begin();
  for (int left = port.available(); left > 0; left--) pipe.put(static_cast<uint8_t>(port.read()));
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
