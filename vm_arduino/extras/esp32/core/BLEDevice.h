// Stands for libraries/BLE/src/ of the core: BLEDevice.h, BLEServer.h, BLE2902.h and what they
// include.

#ifndef TINISCRIPT_CORE_BLEDEVICE_H_
#define TINISCRIPT_CORE_BLEDEVICE_H_

#include "Arduino.h"

// What the core has of names: std::string in version 2, String in version 3.
#if ESP_ARDUINO_VERSION_MAJOR >= 3 || !__STDC_HOSTED__
typedef String BleText;
#else
#include <string>
typedef std::string BleText;
#endif

// components/bt/host/bluedroid/api/include/api/esp_gatts_api.h
typedef union {
  struct gatts_mtu_evt_param {
    uint16_t conn_id;
    uint16_t mtu;
  } mtu;
} esp_ble_gatts_cb_param_t;

class BLECharacteristic;
class BLEServer;

class BLEDescriptor {};

class BLE2902 : public BLEDescriptor {};

class BLECharacteristicCallbacks {
 public:
  virtual ~BLECharacteristicCallbacks() {}
  typedef enum {
    SUCCESS_INDICATE,
    SUCCESS_NOTIFY,
    ERROR_INDICATE_DISABLED,
    ERROR_NOTIFY_DISABLED,
    ERROR_GATT,
    ERROR_NO_CLIENT,
    ERROR_INDICATE_TIMEOUT,
    ERROR_INDICATE_FAILURE
  } Status;

  virtual void onWrite(BLECharacteristic* pCharacteristic);
  virtual void onStatus(BLECharacteristic* pCharacteristic, Status s, uint32_t code);
};

class BLECharacteristic {
 public:
  static const uint32_t PROPERTY_WRITE = 1 << 1;
  static const uint32_t PROPERTY_NOTIFY = 1 << 2;
  static const uint32_t PROPERTY_WRITE_NR = 1 << 5;
  void addDescriptor(BLEDescriptor* pDescriptor);
  uint8_t* getData();
  size_t getLength();
  void notify(bool is_notification = true);
  void setCallbacks(BLECharacteristicCallbacks* pCallbacks);
  void setValue(uint8_t* data, size_t size);
};

class BLEService {
 public:
  BLECharacteristic* createCharacteristic(const char* uuid, uint32_t properties);
  void start();
};

class BLEServerCallbacks {
 public:
  virtual ~BLEServerCallbacks() {}
  virtual void onConnect(BLEServer* pServer);
  virtual void onDisconnect(BLEServer* pServer);
  virtual void onMtuChanged(BLEServer* pServer, esp_ble_gatts_cb_param_t* param);
};

class BLEServer {
 public:
  BLEService* createService(const char* uuid);
  void setCallbacks(BLEServerCallbacks* pCallbacks);
};

class BLEAdvertising {
 public:
  void addServiceUUID(const char* serviceUUID);
  void setScanResponse(bool);
};

class BLEDevice {
 public:
  static BLEServer* createServer();
  static BLEAdvertising* getAdvertising();
  static void init(BleText deviceName);
  static esp_err_t setMTU(uint16_t mtu);
  static void startAdvertising();
};

#endif  // TINISCRIPT_CORE_BLEDEVICE_H_
