// Does what the simulated chip refuses, one thing a run: `refusals ROW` of `refuses.md`.
//
// Ends with status 0 where the call has said no, with 2 where this core does not have the call, with
// 1 where nothing was refused.

#include <BLE2902.h>
#include <BLEServer.h>
#include <ESPmDNS.h>
#include <WiFi.h>
#include <errno.h>
#include <esp_task_wdt.h>
#include <esp_timer.h>
#include <freertos/task.h>
#include <lwip/sockets.h>
#include <nvs.h>
#include <string.h>

#include <string>
#ifdef CONFIG_BT_SPP_ENABLED
#include <BluetoothSerial.h>
#endif

#include "simulated_chip.h"
#include "simulated_radio.h"

void setup() {}
void loop() {}

namespace {

constexpr uint8_t kPin = 5;
portMUX_TYPE mux = portMUX_INITIALIZER_UNLOCKED;

enum Result { kTaken, kRefused, kNotHere };

class Told : public BLECharacteristicCallbacks {
 public:
  Status status = SUCCESS_NOTIFY;
  void onStatus(BLECharacteristic*, Status its, uint32_t) override { status = its; }
};

class Nobody : public BLEServerCallbacks {};
class Deaf : public BLECharacteristicCallbacks {};

Told told;
Nobody nobody;
Deaf deaf;

BLECharacteristic* begun_low_energy() {
  BLEDevice::init("robot");
  BLEServer* const server = BLEDevice::createServer();
  server->setCallbacks(&nobody);
  BLEService* const service = server->createService("service");
  BLECharacteristic* const its =
      service->createCharacteristic("out", BLECharacteristic::PROPERTY_NOTIFY);
  service->createCharacteristic("in", BLECharacteristic::PROPERTY_WRITE)->setCallbacks(&deaf);
  its->setCallbacks(&told);
  service->start();
  BLEDevice::startAdvertising();
  low_energy_connect();
  return its;
}

Result notified(bool is_asked_for, bool is_congested, size_t length) {
  BLECharacteristic* const its = begun_low_energy();
  low_energy_subscribe(is_asked_for);
  low_energy_congest(is_congested);
  std::string bytes(length, 'x');
  its->setValue(reinterpret_cast<uint8_t*>(&bytes[0]), bytes.size());
  its->notify();
  const std::vector<std::string> found = low_energy_notified();
  if (is_asked_for && !is_congested) return found[0].size() < length ? kRefused : kTaken;
  return told.status != Told::SUCCESS_NOTIFY && found.empty() ? kRefused : kTaken;
}

void begin_low_energy(void*) {
  BLEDevice::init("robot");
  for (;;) vTaskDelay(1);
}

void begin_ledc(uint32_t hertz, uint8_t bits, uint8_t channel) {
#if ESP_ARDUINO_VERSION_MAJOR >= 3
  ledcAttachChannel(kPin, hertz, bits, channel);
#else
  ledcSetup(channel, hertz, bits);
#endif
}

void watch() {
#if ESP_ARDUINO_VERSION_MAJOR >= 3
  esp_task_wdt_config_t its = {};
  its.timeout_ms = 1000;
  its.idle_core_mask = 1;
  its.trigger_panic = true;
  esp_task_wdt_reconfigure(&its);
#else
  esp_task_wdt_init(1, true);
#endif
}

Result put(size_t length, const char* key = "key") {
  nvs_handle_t handle;
  nvs_open("tiniscript", NVS_READWRITE, &handle);
  const std::string bytes(length, 'x');
  return nvs_set_blob(handle, key, bytes.data(), bytes.size()) == ESP_OK ? kTaken : kRefused;
}

void never(void*) {}

void of_a_timer(void*) {}

Result inside(const std::string& row) {
  simulated_enter_critical(&mux);
  if (row == "vTaskDelay in a critical section") vTaskDelay(1);
  if (row == "pinMode in a critical section") pinMode(kPin, OUTPUT);
  if (row == "attachInterrupt in a critical section") attachInterrupt(kPin, nullptr, CHANGE);
  if (row == "analogRead in a critical section") analogRead(kPin);
  if (row == "Serial in a critical section") Serial.available();
  if (row == "NVS in a critical section") put(1);
#if ESP_ARDUINO_VERSION_MAJOR >= 3
  if (row == "ledcAttachChannel in a critical section") ledcAttachChannel(kPin, 1000, 8, 0);
  if (row == "ledcChangeFrequency in a critical section") ledcChangeFrequency(kPin, 1000, 8);
#else
  if (row == "ledcSetup in a critical section") ledcSetup(0, 1000, 8);
  if (row == "ledcAttachPin in a critical section") ledcAttachPin(kPin, 0);
#endif
  return kNotHere;
}

Result of_radios(const std::string& row) {
  if (row == "WiFi without modem sleep beside Bluetooth") {
    WiFi.setSleep(false);
    WiFi.mode(WIFI_STA);
    BLEDevice::init("robot");
  } else if (row == "Bluetooth that begins in two tasks at once") {
    for (int k = 0; k < 2; k++) {
      xTaskCreatePinnedToCore(begin_low_energy, "task", 4096, nullptr, 1, nullptr, 0);
    }
    pass_us(100000);
  } else if (row == "Bluetooth LE before BLEDevice::init") {
    BLEDevice::createServer();
  } else if (row == "advertising before the service has started") {
    BLEDevice::init("robot");
    BLEDevice::createServer();
    BLEDevice::startAdvertising();
  } else if (row == "a part of a service that has started") {
    static BLE2902 part;
    begun_low_energy()->addDescriptor(&part);
  } else if (row == "an MTU that Bluetooth LE does not have") {
    BLEDevice::init("robot");
    BLEDevice::setMTU(518);
  } else if (row == "a notification for a stack that is congested") {
    return notified(true, true, 20);
  } else if (row == "a notification that nobody has asked for") {
    return notified(false, false, 20);
  } else if (row == "a notification that is longer than was agreed") {
    return notified(true, false, 21);
  } else if (row == "softAPdisconnect where there is no access point") {
    WiFi.mode(WIFI_STA);
    WiFi.softAPdisconnect(true);
  } else if (row == "a host name after WiFi has begun") {
    WiFi.mode(WIFI_STA);
    WiFi.setHostname("robot");
  } else if (row == "WiFi that learns too late to keep no password") {
    WiFi.mode(WIFI_STA);
    WiFi.persistent(false);
  } else if (row == "a network whose name has no letter or more than 32") {
    WiFi.mode(WIFI_STA);
    const std::string name(33, 'x');
    const bool is_taken = WiFi.begin("", "12345678") != WL_CONNECT_FAILED ||
                          WiFi.begin(name.c_str(), "12345678") != WL_CONNECT_FAILED;
    return is_taken ? kTaken : kRefused;
  } else if (row == "an access point with a password of less than 8") {
    WiFi.mode(WIFI_AP);
    return WiFi.softAP("robot", "1234567") ? kTaken : kRefused;
  } else if (row == "the network before WiFi has begun") {
    lwip_socket(AF_INET, SOCK_STREAM, 0);
  } else if (row == "more than 16 sockets") {
    WiFi.mode(WIFI_STA);
    for (int k = 0; k < 16; k++) lwip_socket(AF_INET, SOCK_STREAM, 0);
    return lwip_socket(AF_INET, SOCK_STREAM, 0) < 0 && errno == ENFILE ? kRefused : kTaken;
  } else {
    return kNotHere;
  }
  return kTaken;
}

Result of_pins(const std::string& row) {
  if (row == "a pin that the chip does not have free") {
    pinMode(11, OUTPUT);
  } else if (row == "an output on a pin that only reads") {
#ifdef CONFIG_IDF_TARGET_ESP32
    pinMode(34, OUTPUT);
#else
    return kNotHere;
#endif
  } else if (row == "a pull-up on a pin that has none") {
#ifdef CONFIG_IDF_TARGET_ESP32
    pinMode(34, INPUT_PULLUP);
#else
    return kNotHere;
#endif
  } else if (row == "an interrupt of another kind") {
    attachInterrupt(kPin, nullptr, RISING);
  } else if (row == "analogRead of a pin without a converter") {
    analogRead(18);
  } else if (row == "analogRead of the second converter beside WiFi") {
    WiFi.mode(WIFI_STA);
#ifdef CONFIG_IDF_TARGET_ESP32
    analogRead(25);
#else
    analogRead(5);
#endif
  } else if (row == "a channel of LEDC that the chip does not have") {
    begin_ledc(1000, 8, 16);
  } else if (row == "more bits of LEDC than the chip has") {
    begin_ledc(10, 21, 0);
  } else if (row == "a frequency that no clock of LEDC makes with so many bits") {
    begin_ledc(1000, 8, 0);
    begin_ledc(200000, 10, 0);
#ifdef CONFIG_IDF_TARGET_ESP32C3
    begin_ledc(37, 10, 0);
#endif
    return chip.channels[0].hertz == 1000 && chip.channels[0].bits == 8 ? kRefused : kTaken;
  } else if (row == "a duty of a channel that is not set up") {
    ledcWrite(0, 1);
  } else if (row == "room of a serial port that has begun") {
    Serial.begin(115200);
    Serial.setTxBufferSize(1000);
  } else if (row == "a byte for a serial port that has no room") {
    while (chip.sending <= chip.send_room) Serial.write(1);
  } else {
    return kNotHere;
  }
  return kTaken;
}

Result of_system(const std::string& row) {
  if (row == "a task on a core that the chip does not have") {
    xTaskCreatePinnedToCore(never, "task", 4096, nullptr, 1, nullptr, portNUM_PROCESSORS);
  } else if (row == "a task that calculates for long beside an idle task that is watched") {
    watch();
    xTaskCreatePinnedToCore(never, "task", 4096, nullptr, 1, nullptr, 0);
  } else if (row == "the end of no critical section") {
    simulated_exit_critical(&mux);
  } else if (row == "the task watchdog before it has begun") {
    esp_task_wdt_add(nullptr);
  } else if (row == "the task watchdog fed by who is not watched") {
    esp_task_wdt_reset();
  } else if (row == "a timer that runs already") {
    esp_timer_create_args_t settings = {};
    settings.callback = of_a_timer;
    esp_timer_handle_t timer = nullptr;
    esp_timer_create(&settings, &timer);
    for (int k = 0; k < 2; k++) esp_timer_start_periodic(timer, 10000);
  } else if (row == "a key of NVS that is too long") {
    put(1, "sixteen letters!");
  } else if (row == "handles of NVS that are left open") {
    for (int k = 0; k < 9; k++) put(1);
  } else if (row == "a value of NVS for which there is no room") {
    return put(70000);
  } else if (row == "a value of NVS that is longer than asked for") {
    put(9);
    nvs_handle_t handle;
    nvs_open("tiniscript", NVS_READWRITE, &handle);
    uint8_t bytes[8];
    size_t length = sizeof bytes;
    return nvs_get_blob(handle, "key", bytes, &length) == ESP_OK ? kTaken : kRefused;
  } else {
    return kNotHere;
  }
  return kTaken;
}

}  // namespace

int main(int, char** words) {
  const std::string row = words[1];
  for (SimulatedPin& pin : chip.pins) pin.signal = 0;
  for (Result (*of)(const std::string&) : {of_radios, of_pins, of_system, inside}) {
    const Result found = of(row);
    if (found != kNotHere) _Exit(found == kRefused ? 0 : 1);
  }
  _Exit(2);
}
