// Bluetooth with a serial port (SPP) of an ESP32; its successors lack it.
//
// The core's own task delivers received bytes, connections and disconnections; the task of this
// radio sends.

#ifdef ARDUINO_ARCH_ESP32

#include <Arduino.h>

#include "radio.h"

#ifdef CONFIG_BT_SPP_ENABLED
#include <BluetoothSerial.h>

namespace tiniscript {

namespace {

BluetoothSerial port;
// The core's task alone.
uint32_t handle;    // of the client; 0: none
uint32_t heard_ms;  // when something was heard of the client, or it came

Pipe& pipe() { return radio_pipe(Transport::kSerialPort); }

// The core sends a second client away, and the first one stays. The next try of the second one
// finds the place free, if the first one has been silent for long.
void on_client(uint32_t found) {
  const uint32_t now_ms = static_cast<uint32_t>(millis());
  if (handle == 0) {
    handle = found;
    heard_ms = now_ms;
    pipe().begin();
  } else if (now_ms - heard_ms >= kPlaceMs) {
    esp_spp_disconnect(handle);
  }
}

void on_event(esp_spp_cb_event_t event, esp_spp_cb_param_t* its) {
  if (event == ESP_SPP_SRV_OPEN_EVT && its->srv_open.status == ESP_SPP_SUCCESS) {
    on_client(its->srv_open.handle);
  } else if (event == ESP_SPP_CLOSE_EVT && handle != 0 && !port.hasClient()) {
    handle = 0;
    pipe().part();
  }
}

// This replaces the core's queue, which has 512 places and drops what does not fit.
void on_data(const uint8_t* bytes, size_t length) {
  heard_ms = static_cast<uint32_t>(millis());
  for (size_t k = 0; k < length; k++) pipe().put(bytes[k], static_cast<uint16_t>(heard_ms));
}

}  // namespace

bool spp_begin() {
  port.register_callback(on_event);
  port.onData(on_data);
  return port.begin(radio_name().name);
}

// `write` blocks while the peer accepts no bytes, up to a second: only this task waits.
void spp_turn() {
  uint8_t bytes[64];
  size_t length = 0;
  while (pipe().is_connected() && length < sizeof bytes && pipe().take(bytes + length)) length++;
  if (length != 0) port.write(bytes, length);
}

}  // namespace tiniscript

#else

namespace tiniscript {

bool spp_begin() { return false; }
void spp_turn() {}

}  // namespace tiniscript

#endif  // CONFIG_BT_SPP_ENABLED

#endif  // ARDUINO_ARCH_ESP32
