// Does what the simulated chip refuses, one thing a run: `refusals ROW`.
//
// A comment says what happens on a chip, and by which source: of ESP-IDF where no other is named.
// Cores are 2.0 (with ESP-IDF 4.4) and 3.0 (5.1). Not simulated, so not refused: how much stack and
// heap a call takes, how long it takes, and esp_random before a radio is on, whose numbers are not
// random then (docs/en/api-reference/system/random.rst).
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
  // an assertion: vTaskDelay in tasks.c; docs/en/api-guides/freertos-smp.rst, "Critical Sections".
  if (row == "vTaskDelay in a critical section") vTaskDelay(1);
  // it logs and takes locks: gpio_config in driver/gpio.c.
  if (row == "pinMode in a critical section") pinMode(kPin, OUTPUT);
  // it allocates and waits for the other core: gpio_install_isr_service in driver/gpio.c.
  if (row == "attachInterrupt in a critical section") attachInterrupt(kPin, nullptr, CHANGE);
  // it takes a lock: adc1_get_raw; adc_oneshot_read.
  if (row == "analogRead in a critical section") analogRead(kPin);
  // it takes a lock: uartAvailable in cores/esp32/esp32-hal-uart.c.
  if (row == "Serial in a critical section") Serial.available();
  // it takes a lock, and writes flash: Lock in nvs_api.cpp.
  if (row == "NVS in a critical section") put(1);
#if ESP_ARDUINO_VERSION_MAJOR >= 3
  // it allocates and logs: ledcAttachChannel of core 3.
  if (row == "ledcAttachChannel in a critical section") ledcAttachChannel(kPin, 1000, 8, 0);
  // it allocates and logs: ledcChangeFrequency of core 3.
  if (row == "ledcChangeFrequency in a critical section") ledcChangeFrequency(kPin, 1000, 8);
#else
  // it allocates and logs: ledc_timer_config in driver/ledc.c.
  if (row == "ledcSetup in a critical section") ledcSetup(0, 1000, 8);
  // it allocates and logs: ledc_channel_config in driver/ledc.c.
  if (row == "ledcAttachPin in a critical section") ledcAttachPin(kPin, 0);
#endif
  return kNotHere;
}

Result of_radios(const std::string& row) {
  if (row == "WiFi without modem sleep beside Bluetooth") {
    // abort when WiFi starts: docs/en/api-guides/wifi.rst, "Modem-sleep": not possible where both
    // coexist; esp_wifi_set_ps.
    WiFi.setSleep(false);
    WiFi.mode(WIFI_STA);
    BLEDevice::init("robot");
  } else if (row == "Bluetooth that begins in two tasks at once") {
    // one of them is left without Bluetooth, or both; nothing locks: btStart in
    // cores/esp32/esp32-hal-bt.c, _init_bt in BluetoothSerial.cpp, BLEDevice::init;
    // esp_bluedroid_init: ESP_ERR_INVALID_STATE.
    for (int k = 0; k < 2; k++) {
      xTaskCreatePinnedToCore(begin_low_energy, "task", 4096, nullptr, 1, nullptr, 0);
    }
    pass_us(100000);
  } else if (row == "Bluetooth LE before BLEDevice::init") {
    // waits for ever, or ESP_ERR_INVALID_STATE: BLEServer::createApp; esp_ble_gatt_set_local_mtu in
    // esp_gatt_common_api.c.
    BLEDevice::createServer();
  } else if (row == "advertising before the service has started") {
    // a client finds no service: BLEService::start.
    BLEDevice::init("robot");
    BLEDevice::createServer();
    BLEDevice::startAdvertising();
  } else if (row == "a part of a service that has started") {
    // it is not there for clients: BLEService::start creates what it has by then.
    static BLE2902 part;
    begun_low_energy()->addDescriptor(&part);
  } else if (row == "an MTU that Bluetooth LE does not have") {
    // ESP_ERR_INVALID_SIZE: esp_ble_gatt_set_local_mtu.
    BLEDevice::init("robot");
    BLEDevice::setMTU(518);
  } else if (row == "a notification for a stack that is congested") {
    // it is lost: esp_ble_gatts_send_indicate in esp_gatts_api.c: ESP_FAIL;
    // BLECharacteristic::notify tells onStatus.
    return notified(true, true, 20);
  } else if (row == "a notification that nobody has asked for") {
    // it is dropped: BLECharacteristic::notify.
    return notified(false, false, 20);
  } else if (row == "a notification that is longer than was agreed") {
    // it is cut: BLECharacteristic::notify.
    return notified(true, false, 21);
  } else if (row == "softAPdisconnect where there is no access point") {
    // opens one for a moment: core 3: APClass::clear in libraries/WiFi/src/AP.cpp begins it.
    WiFi.mode(WIFI_STA);
    WiFi.softAPdisconnect(true);
  } else if (row == "a host name after WiFi has begun") {
    // the name before is used: WiFiGenericClass::mode sets it when the station begins.
    WiFi.mode(WIFI_STA);
    WiFi.setHostname("robot");
  } else if (row == "WiFi that learns too late to keep no password") {
    // NVS keeps it: WiFiGenericClass::mode: wifiLowLevelInit(_persistent).
    WiFi.mode(WIFI_STA);
    WiFi.persistent(false);
  } else if (row == "a network whose name has no letter or more than 32") {
    // WL_CONNECT_FAILED: WiFiSTAClass::begin.
    WiFi.mode(WIFI_STA);
    const std::string name(33, 'x');
    const bool is_taken = WiFi.begin("", "12345678") != WL_CONNECT_FAILED ||
                          WiFi.begin(name.c_str(), "12345678") != WL_CONNECT_FAILED;
    return is_taken ? kTaken : kRefused;
  } else if (row == "an access point with a password of less than 8") {
    // false: WiFiAPClass::softAP.
    WiFi.mode(WIFI_AP);
    return WiFi.softAP("robot", "1234567") ? kTaken : kRefused;
  } else if (row == "the network before WiFi has begun") {
    // an assertion, "Invalid mbox": tcpip_send_msg_wait_sem in lwIP's tcpip.c.
    lwip_socket(AF_INET, SOCK_STREAM, 0);
  } else if (row == "more than 16 sockets") {
    // ENFILE: CONFIG_LWIP_MAX_SOCKETS of both cores' sdkconfig.
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
    // "Invalid pin selected"; the flash stops answering: cores/esp32/esp32-hal-gpio.c; soc_caps.h:
    // SOC_GPIO_VALID_GPIO_MASK; data sheets: pins of the flash.
    pinMode(11, OUTPUT);
  } else if (row == "an output on a pin that only reads") {
    // "can only be input": gpio_set_direction in driver/gpio.c; SOC_GPIO_VALID_OUTPUT_GPIO_MASK.
#ifdef CONFIG_IDF_TARGET_ESP32
    pinMode(34, OUTPUT);
#else
    return kNotHere;
#endif
  } else if (row == "a pull-up on a pin that has none") {
    // it floats: ESP32's data sheet: 34 to 39 have no pull-up.
#ifdef CONFIG_IDF_TARGET_ESP32
    pinMode(34, INPUT_PULLUP);
#else
    return kNotHere;
#endif
  } else if (row == "an interrupt of another kind") {
    // nothing: the simulated chip has no other.
    attachInterrupt(kPin, nullptr, RISING);
  } else if (row == "analogRead of a pin without a converter") {
    // 0, "is not ADC pin": __analogRead in cores/esp32/esp32-hal-adc.c.
    analogRead(18);
  } else if (row == "analogRead of the second converter beside WiFi") {
    // ESP_ERR_TIMEOUT, 0: adc2_get_raw: "this API will fail while WiFi is on".
    WiFi.mode(WIFI_STA);
#ifdef CONFIG_IDF_TARGET_ESP32
    analogRead(25);
#else
    analogRead(5);
#endif
  } else if (row == "a channel of LEDC that the chip does not have") {
    // "No more LEDC channels available": ledcSetup in cores/esp32/esp32-hal-ledc.c.
    begin_ledc(1000, 8, 16);
  } else if (row == "more bits of LEDC than the chip has") {
    // "No more LEDC channels available": SOC_LEDC_TIMER_BIT_WIDE_NUM: 20, and 14 of an ESP32-C3.
    begin_ledc(10, 21, 0);
  } else if (row == "a frequency that no clock of LEDC makes with so many bits") {
    // 0, and all stays as it was: ledc_set_timer_div in driver/ledc.c: "can not be achieved".
    begin_ledc(1000, 8, 0);
    begin_ledc(200000, 10, 0);
#ifdef CONFIG_IDF_TARGET_ESP32C3
    begin_ledc(37, 10, 0);
#endif
    return chip.channels[0].hertz == 1000 && chip.channels[0].bits == 8 ? kRefused : kTaken;
  } else if (row == "a duty of a channel that is not set up") {
    // "LEDC is not initialized": ledc_set_duty in driver/ledc.c.
    ledcWrite(0, 1);
  } else if (row == "room of a serial port that has begun") {
    // 0, "can't be resized": HardwareSerial::setRxBufferSize.
    Serial.begin(115200);
    Serial.setTxBufferSize(1000);
  } else if (row == "a byte for a serial port that has no room") {
    // it waits: uart_write_bytes in driver/uart.c.
    while (chip.sending <= chip.send_room) Serial.write(1);
  } else {
    return kNotHere;
  }
  return kTaken;
}

Result of_system(const std::string& row) {
  if (row == "a task on a core that the chip does not have") {
    // an assertion: xTaskCreatePinnedToCore in components/freertos/tasks.c: taskVALID_CORE_ID.
    xTaskCreatePinnedToCore(never, "task", 4096, nullptr, 1, nullptr, portNUM_PROCESSORS);
  } else if (row == "a task that calculates for long beside an idle task that is watched") {
    // the task watchdog restarts it: CONFIG_ESP_TASK_WDT_CHECK_IDLE_TASK_CPU0 of the cores'
    // sdkconfig.
    watch();
    xTaskCreatePinnedToCore(never, "task", 4096, nullptr, 1, nullptr, 0);
  } else if (row == "the end of no critical section") {
    // an assertion: vPortExitCritical in port.c.
    simulated_exit_critical(&mux);
  } else if (row == "the task watchdog before it has begun") {
    // ESP_ERR_INVALID_STATE: esp_task_wdt_add in task_wdt.c.
    esp_task_wdt_add(nullptr);
  } else if (row == "the task watchdog fed by who is not watched") {
    // ESP_ERR_NOT_FOUND: esp_task_wdt_reset in task_wdt.c.
    esp_task_wdt_reset();
  } else if (row == "a timer that runs already") {
    // ESP_ERR_INVALID_STATE: esp_timer_start_periodic in esp_timer.c.
    esp_timer_create_args_t settings = {};
    settings.callback = of_a_timer;
    esp_timer_handle_t timer = nullptr;
    esp_timer_create(&settings, &timer);
    for (int k = 0; k < 2; k++) esp_timer_start_periodic(timer, 10000);
  } else if (row == "a key of NVS that is too long") {
    // ESP_ERR_NVS_KEY_TOO_LONG: nvs.h: NVS_KEY_NAME_MAX_SIZE.
    put(1, "sixteen letters!");
  } else if (row == "handles of NVS that are left open") {
    // each keeps memory of the heap: NVSHandleEntry in nvs_api.cpp.
    for (int k = 0; k < 9; k++) put(1);
  } else if (row == "a value of NVS for which there is no room") {
    // ESP_ERR_NVS_NOT_ENOUGH_SPACE: nvs.h.
    return put(70000);
  } else if (row == "a value of NVS that is longer than asked for") {
    // ESP_ERR_NVS_INVALID_LENGTH: nvs.h.
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
