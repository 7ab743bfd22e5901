// Bluetooth LE: the Nordic UART service, with the robot's name in the advertisement.
//
// The core's own task calls what is written to the robot, and who connects and leaves; the task of
// this radio sends notifications.

#ifdef ARDUINO_ARCH_ESP32

#include <Arduino.h>
#include <BLE2902.h>
#include <BLEDevice.h>
#include <BLEServer.h>

#include "radio.h"

#ifdef CONFIG_NIMBLE_ENABLED
#error "An ESP32-C3 wants the core esp32 2.0.17 to 3.2 by Espressif, or pio run: see docs/esp32.md"
#endif

namespace tiniscript {

namespace {

constexpr char kService[] = "6e400001-b5a3-f393-e0a9-e50e24dcca9e";
constexpr char kToRobot[] = "6e400002-b5a3-f393-e0a9-e50e24dcca9e";
constexpr char kToComputer[] = "6e400003-b5a3-f393-e0a9-e50e24dcca9e";

constexpr uint16_t kLeastMtu = 23;  // until another one is agreed
constexpr uint16_t kMostMtu = 247;
constexpr uint16_t kMtuHead = 3;    // bytes of it that are no payload
constexpr uint8_t kPauseTurns = 4;  // between two notifications: the stack takes no more at once

uint16_t mtu = kLeastMtu;
uint8_t clients;  // so far; the core's task counts
BLECharacteristic* to_computer;

// The radio's task: a notification that waits, and for which client.
uint8_t waiting[kMostMtu - kMtuHead];
size_t length;
uint8_t its_client;
bool is_sent;
uint8_t pause_turns;

Pipe& pipe() { return radio_pipe(Transport::kLowEnergy); }

class Heard : public BLECharacteristicCallbacks {
 public:
  void onWrite(BLECharacteristic* its) override {
    const uint8_t* const bytes = its->getData();
    const size_t length = its->getLength();
    const uint16_t now_ms = static_cast<uint16_t>(millis());
    for (size_t k = 0; k < length; k++) pipe().put(bytes[k], now_ms);
  }
};

// Of a notification. The stack takes none while it is congested, nor before somebody has asked for
// them.
class Taken : public BLECharacteristicCallbacks {
 public:
  void onStatus(BLECharacteristic*, Status its, uint32_t) override {
    is_sent = its == Status::SUCCESS_NOTIFY;
  }
};

class Client : public BLEServerCallbacks {
 public:
  void onConnect(BLEServer*) override {
    __atomic_store_n(&mtu, kLeastMtu, __ATOMIC_RELAXED);
    __atomic_store_n(&clients, static_cast<uint8_t>(clients + 1), __ATOMIC_RELAXED);
    pipe().begin();
  }
  void onDisconnect(BLEServer*) override {
    pipe().part();
    BLEDevice::startAdvertising();
  }
  void onMtuChanged(BLEServer*, esp_ble_gatts_cb_param_t* its) override {
    const uint16_t found = its->mtu.mtu;
    const uint16_t agreed = found < kLeastMtu ? kLeastMtu : found > kMostMtu ? kMostMtu : found;
    __atomic_store_n(&mtu, agreed, __ATOMIC_RELAXED);
  }
};

}  // namespace

void low_energy_begin() {
  static Heard heard;
  static Taken taken;
  static Client client;
  static BLE2902 notifications;
  BLEDevice::init(radio_name().name);
  BLEDevice::setMTU(kMostMtu);
  BLEServer* const server = BLEDevice::createServer();
  server->setCallbacks(&client);
  BLEService* const service = server->createService(kService);
  to_computer = service->createCharacteristic(kToComputer, BLECharacteristic::PROPERTY_NOTIFY);
  to_computer->addDescriptor(&notifications);
  to_computer->setCallbacks(&taken);
  BLECharacteristic* const to_robot = service->createCharacteristic(
      kToRobot, BLECharacteristic::PROPERTY_WRITE | BLECharacteristic::PROPERTY_WRITE_NR);
  to_robot->setCallbacks(&heard);
  service->start();
  BLEAdvertising* const advertising = BLEDevice::getAdvertising();
  advertising->addServiceUUID(kService);
  advertising->setScanResponse(true);  // the name is in it
  BLEDevice::startAdvertising();
}

void low_energy_turn() {
  if (pause_turns != 0) {
    pause_turns--;
    return;
  }
  const uint8_t client = __atomic_load_n(&clients, __ATOMIC_RELAXED);
  if (client != its_client) length = 0;  // what waits is for one before
  its_client = client;
  if (!pipe().is_connected()) return;
  const size_t most = static_cast<size_t>(__atomic_load_n(&mtu, __ATOMIC_RELAXED) - kMtuHead);
  while (length < most && pipe().take(waiting + length)) length++;
  if (length == 0) return;
  is_sent = false;
  to_computer->setValue(waiting, length);
  to_computer->notify();
  if (is_sent) length = 0;
  pause_turns = kPauseTurns;
}

}  // namespace tiniscript

#endif  // ARDUINO_ARCH_ESP32
