#ifdef ARDUINO_ARCH_ESP32

#include "radio.h"

#include <Arduino.h>
#include <esp_log.h>
#include <freertos/task.h>

#include "broker_settings.h"
#include "wifi_settings.h"

namespace tiniscript {

namespace {

constexpr uint8_t kBytesATurn = 128;  // of a transport, taken in a turn of the main loop
constexpr uint32_t kStackBytes = 6144;
constexpr uint32_t kTlsStackBytes = 10240;
constexpr uint32_t kRestMs = 100;    // between two turns of the idle task
constexpr uint32_t kAgainMs = 1000;  // until the broker's task is tried again
constexpr int kPriority = 1;  // that of the main loop
constexpr int kCore = 0;
constexpr uint8_t kFirst = static_cast<uint8_t>(Transport::kSerialPort);

struct Radio {
  const char* name;
  void (*begin)();
  void (*turn)();
  uint32_t stack_bytes;
};

void begin_bluetooth();

const Radio kSerialPortRadio = {"tini spp", nullptr, spp_turn, kStackBytes};
const Radio kLowEnergyRadio = {"tini ble", begin_bluetooth, low_energy_turn, kStackBytes};
const Radio kNetworkRadio = {"tini wifi", network_begin, network_turn, kStackBytes};
const Radio kBrokerRadio = {"tini mqtt", nullptr, broker_turn, kTlsStackBytes};

Pipe pipes[kTransports - kFirst];
RadioName name;
bool has_begun;
uint32_t last_rest_ms;
bool has_broker;
bool has_broker_failed;  // to begin its task
uint32_t broker_failed_ms;

// A task: when the radio blocks, only this task waits.
void run(void* argument) {
  const Radio& radio = *static_cast<const Radio*>(argument);
  if (radio.begin != nullptr) radio.begin();
  for (;;) {
    radio.turn();
    vTaskDelay(1);
  }
}

// Whether there was memory for it.
bool begin(const Radio& radio) {
  return xTaskCreatePinnedToCore(run, radio.name, radio.stack_bytes, const_cast<Radio*>(&radio),
                                 kPriority, nullptr, kCore) == pdPASS;
}

// Both kinds of Bluetooth begin the same controller and the same stack, without a lock: this task
// begins one after the other. Sending to a serial port blocks, so that has its own task, too.
void begin_bluetooth() {
  const bool has_port = spp_begin();
  low_energy_begin();
  if (has_port) begin(kSerialPortRadio);
}

// The broker has a task of its own: looking its name up waits, and TLS calculates, for seconds. A
// user without a broker loses no stack to it.
void begin_broker() {
  if (!has_begun || has_broker || !broker_is_set()) return;
  const uint32_t now_ms = static_cast<uint32_t>(millis());
  if (has_broker_failed && now_ms - broker_failed_ms < kAgainMs) return;
  has_broker = begin(kBrokerRadio);
  has_broker_failed = !has_broker;
  broker_failed_ms = now_ms;
  broker_note_memory(has_broker);
}

// On a chip with one core, the main loop would leave no time for the idle task, which frees what
// tasks leave behind.
void yield_to_idle_task() {
  const uint32_t now_ms = static_cast<uint32_t>(millis());
  if (portNUM_PROCESSORS > 1 || now_ms - last_rest_ms < kRestMs) return;
  last_rest_ms = now_ms;
  vTaskDelay(1);
}

void on_rx_byte(Transport transport, uint8_t byte) {
  firmware_on_rx_byte(transport, byte, static_cast<uint16_t>(millis()));
}

}  // namespace

Pipe& radio_pipe(Transport transport) { return pipes[static_cast<uint8_t>(transport) - kFirst]; }

const RadioName& radio_name() { return name; }

void radio_tick() {
  begin_broker();
  if (has_begun || !firmware_radio_name(&name)) return;
  has_begun = true;
  esp_log_level_set("*", ESP_LOG_NONE);  // libraries would tell their errors in the link's bytes
  wifi_load();
  broker_load();
  begin(kLowEnergyRadio);
  begin(kNetworkRadio);
}

namespace {

// Bytes wait in the pipe while there is no room for text: a person pastes faster than it is read.
void take(Transport transport, Pipe* pipe) {
  uint16_t item;
  for (uint8_t bytes_left = kBytesATurn; bytes_left > 0 && firmware_has_room(transport);
       bytes_left--) {
    if (!pipe->take_rx(&item)) return;
    if (item == Pipe::kClientLeft) {
      firmware_on_client_left(transport);
    } else {
      on_rx_byte(transport, static_cast<uint8_t>(item));
    }
  }
}

// A stop that the bytes do not have.
void stop(Transport transport) {
  for (uint8_t zeros = 0; zeros < kStopZeros; zeros++) on_rx_byte(transport, 0);
}

}  // namespace

// A stop outside the bytes takes effect before older bytes that still wait. The same applies to a
// waiting one: the receiver decides what it belongs to when it arrives.
void radio_poll() {
  for (uint8_t place = kFirst; place < kTransports; place++) {
    const Transport transport = static_cast<Transport>(place);
    Pipe& pipe = radio_pipe(transport);
    Place running_place;
    const bool stops_run = pipe.take_silent_stop() && firmware_runs(&running_place);
    if (pipe.take_stop() || stops_run) stop(transport);
    take(transport, &pipe);
    if (pipe.has_run_stop() && firmware_runs(&running_place)) stop(transport);
    firmware_await_stop(transport, pipe.has_stop());
  }
}

// Bytes meant for nobody are discarded.
void radio_send() {
  yield_to_idle_task();
  for (uint8_t place = kFirst; place < kTransports; place++) {
    const Transport transport = static_cast<Transport>(place);
    Pipe& pipe = radio_pipe(transport);
    const bool is_connected = pipe.is_connected();
    pipe.note_key(firmware_has_key(transport));
    uint8_t byte;
    while ((!is_connected || pipe.has_room()) && firmware_next_tx_byte(transport, &byte)) {
      if (is_connected) pipe.put_tx(byte);
    }
  }
}

uint8_t radio_lost() {
  uint8_t lost_bytes = 0;
  for (const Pipe& pipe : pipes) lost_bytes = static_cast<uint8_t>(lost_bytes + pipe.lost());
  return lost_bytes;
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
