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

uint8_t client_count;  // so far: the core's task writes it, the radio's reads it

// The radio's task: bytes that wait, and for which client.
uint8_t outgoing[64];
size_t length;
uint8_t outgoing_client;

Pipe& pipe() { return radio_pipe(Transport::kSerialPort); }

// The core sends a second client away, and the first one stays. The next try of the second one
// finds the place free, if the first one has been silent for long.
void on_client(uint32_t new_handle) {
  const uint32_t now_ms = static_cast<uint32_t>(millis());
  if (handle == 0) {
    handle = new_handle;
    heard_ms = now_ms;
    __atomic_store_n(&client_count, static_cast<uint8_t>(client_count + 1), __ATOMIC_RELAXED);
    pipe().begin();
  } else if (now_ms - heard_ms >= kPlaceMs) {
    esp_spp_disconnect(handle);
  }
}

void on_event(esp_spp_cb_event_t event, esp_spp_cb_param_t* param) {
  if (event == ESP_SPP_SRV_OPEN_EVT && param->srv_open.status == ESP_SPP_SUCCESS) {
    on_client(param->srv_open.handle);
  } else if (event == ESP_SPP_CLOSE_EVT && handle != 0 && !port.hasClient()) {
    handle = 0;
    pipe().end_client();
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

// `write` blocks while the peer accepts no bytes, up to a second: only this task waits. Then it has
// accepted none.
void spp_turn() {
  const uint8_t count = __atomic_load_n(&client_count, __ATOMIC_RELAXED);
  if (count != outgoing_client) length = 0;  // the waiting bytes are for an earlier client
  outgoing_client = count;
  if (!pipe().is_connected()) return;
  while (length < sizeof outgoing && pipe().take(outgoing + length)) length++;
  if (length != 0 && port.write(outgoing, length) != 0) length = 0;
}

}  // namespace tiniscript

#else

namespace tiniscript {

bool spp_begin() { return false; }
void spp_turn() {}

}  // namespace tiniscript

#endif  // CONFIG_BT_SPP_ENABLED

#endif  // ARDUINO_ARCH_ESP32
