// Bluetooth LE: the Nordic UART service, with the robot's name in the advertisement.
//
// The stack's task reports data written to the robot, and clients that connect and leave, with the
// number of the connection; the task of this radio sends notifications. It uses none of the core's
// objects: they change in the stack's task, without a lock.

#ifdef ARDUINO_ARCH_ESP32

#include <Arduino.h>
#include <BLE2902.h>
#include <BLEDevice.h>
#include <BLEServer.h>

#include "radio.h"

#ifdef CONFIG_NIMBLE_ENABLED
#error "An ESP32-C3 wants the core esp32 2.0.17 to 3.2 by Espressif, or pio run: see docs/develop/esp32.md"
#endif

namespace tiniscript {

namespace {

constexpr char kService[] = "6e400001-b5a3-f393-e0a9-e50e24dcca9e";
constexpr char kToRobot[] = "6e400002-b5a3-f393-e0a9-e50e24dcca9e";
constexpr char kToComputer[] = "6e400003-b5a3-f393-e0a9-e50e24dcca9e";

constexpr uint16_t kMinMtu = 23;  // until another one is agreed
constexpr uint16_t kMaxMtu = 247;
constexpr uint16_t kMtuHead = 3;    // bytes of it that are no payload
constexpr uint8_t kPauseTurns = 4;  // between two notifications: the stack takes no more at once

constexpr uint16_t kNobody = 0xffff;

// The stack's task writes these, the radio's reads them.
uint16_t mtu = kMinMtu;
uint16_t client = kNobody;  // the client with the place: the number of its connection
uint8_t interface;
bool has_subscribed;
uint8_t client_count;  // so far

// The stack's task alone.
BLEServer* server;
uint32_t heard_ms;  // when something was heard of that client, or it came

// The radio's task: a notification that waits, and for which client.
uint16_t notify_handle;  // the handle of the characteristic
uint8_t outgoing[kMaxMtu - kMtuHead];
size_t length;
uint8_t outgoing_client;
uint8_t pause_turns;

BLE2902* subscription;

template <class Value>
void store_relaxed(Value* target, Value value) {
  __atomic_store_n(target, value, __ATOMIC_RELAXED);
}

template <class Value>
Value load_relaxed(const Value& source) {
  return __atomic_load_n(&source, __ATOMIC_RELAXED);
}

Pipe& pipe() { return radio_pipe(Transport::kLowEnergy); }

class WriteCallbacks : public BLECharacteristicCallbacks {
 public:
  void onWrite(BLECharacteristic* characteristic, esp_ble_gatts_cb_param_t* event) override {
    if (event->write.conn_id != client) return;
    const uint8_t* const bytes = characteristic->getData();
    const size_t length = characteristic->getLength();
    heard_ms = static_cast<uint32_t>(millis());
    for (size_t k = 0; k < length; k++) pipe().put(bytes[k], static_cast<uint16_t>(heard_ms));
  }
};

void drop_client() {
  if (client != kNobody) pipe().end_client();
  store_relaxed(&client, kNobody);
}

// A newcomer gets the place if it is free, or if its holder has been silent for long.
void on_connect(uint8_t new_interface, uint16_t new_client) {
  const uint32_t now_ms = static_cast<uint32_t>(millis());
  if (client != kNobody && now_ms - heard_ms < kPlaceMs) return server->disconnect(new_client);
  if (client != kNobody) server->disconnect(client);
  drop_client();
  heard_ms = now_ms;
  store_relaxed(&mtu, kMinMtu);
  store_relaxed(&has_subscribed, false);
  store_relaxed(&interface, new_interface);
  store_relaxed(&client, new_client);
  store_relaxed(&client_count, static_cast<uint8_t>(client_count + 1));
  pipe().begin();
}

void on_mtu(uint16_t new_mtu) {
  store_relaxed(&mtu, new_mtu < kMinMtu ? kMinMtu : new_mtu > kMaxMtu ? kMaxMtu : new_mtu);
}

// The core has done its part by then. The stack stops advertising after a connection: then no other
// client could connect.
void on_event(esp_gatts_cb_event_t event, esp_gatt_if_t new_interface,
              esp_ble_gatts_cb_param_t* param) {
  switch (event) {
    case ESP_GATTS_CONNECT_EVT:
      on_connect(new_interface, param->connect.conn_id);
      return BLEDevice::startAdvertising();
    case ESP_GATTS_DISCONNECT_EVT:
      if (param->disconnect.conn_id == client) drop_client();
      return BLEDevice::startAdvertising();
    case ESP_GATTS_MTU_EVT:
      if (param->mtu.conn_id == client) on_mtu(param->mtu.mtu);
      return;
    case ESP_GATTS_WRITE_EVT:
      if (param->write.conn_id != client || param->write.len == 0) return;
      if (param->write.handle != subscription->getHandle()) return;
      return store_relaxed(&has_subscribed, (param->write.value[0] & 1) != 0);
    default:
      return;
  }
}

}  // namespace

void low_energy_begin() {
  static WriteCallbacks write_callbacks;
  static BLE2902 notifications;
  subscription = &notifications;
  BLEDevice::init(radio_name().name);
  BLEDevice::setMTU(kMaxMtu);
  BLEDevice::setCustomGattsHandler(on_event);
  server = BLEDevice::createServer();
  BLEService* const service = server->createService(kService);
  BLECharacteristic* const notifier =
      service->createCharacteristic(kToComputer, BLECharacteristic::PROPERTY_NOTIFY);
  notifier->addDescriptor(&notifications);
  BLECharacteristic* const rx_characteristic = service->createCharacteristic(
      kToRobot, BLECharacteristic::PROPERTY_WRITE | BLECharacteristic::PROPERTY_WRITE_NR);
  rx_characteristic->setCallbacks(&write_callbacks);
  service->start();
  notify_handle = notifier->getHandle();
  BLEAdvertising* const advertising = BLEDevice::getAdvertising();
  advertising->addServiceUUID(kService);
  advertising->setScanResponse(true);  // the name is in it
  BLEDevice::startAdvertising();
}

// The stack takes no notification while it is congested.
void low_energy_turn() {
  if (pause_turns != 0) {
    pause_turns--;
    return;
  }
  const uint8_t count = load_relaxed(client_count);
  if (count != outgoing_client) length = 0;  // the waiting bytes are for an earlier client
  outgoing_client = count;
  if (!pipe().is_connected()) return;
  const size_t max_length = static_cast<size_t>(load_relaxed(mtu) - kMtuHead);
  while (length < max_length && pipe().take(outgoing + length)) length++;
  if (length == 0 || !load_relaxed(has_subscribed)) return;
  if (esp_ble_gatts_send_indicate(load_relaxed(interface), load_relaxed(client), notify_handle,
                                  static_cast<uint16_t>(length), outgoing, false) == ESP_OK) {
    length = 0;
  }
  pause_turns = kPauseTurns;
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
