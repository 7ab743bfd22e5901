// Stands for libraries/BLE/src/ of the core: BLEDevice.h, BLEServer.h, BLE2902.h and what they
// include.

#pragma once

#include "Arduino.h"

// What the core has of names: std::string in version 2, String in version 3.
#if ESP_ARDUINO_VERSION_MAJOR >= 3 || !__STDC_HOSTED__
typedef String BleText;
#else
#include <string>
typedef std::string BleText;
#endif

// components/bt/host/bluedroid/api/include/api/esp_gatts_api.h, and esp_gatt_defs.h
typedef enum {
  ESP_GATTS_WRITE_EVT = 2,
  ESP_GATTS_MTU_EVT = 4,
  ESP_GATTS_CONNECT_EVT = 14,
  ESP_GATTS_DISCONNECT_EVT = 15,
} esp_gatts_cb_event_t;
typedef uint8_t esp_gatt_if_t;
typedef union {
  struct gatts_write_evt_param {
    uint16_t conn_id;
    uint16_t handle;
    uint16_t len;
    uint8_t* value;
  } write;
  struct gatts_mtu_evt_param {
    uint16_t conn_id;
    uint16_t mtu;
  } mtu;
  struct gatts_connect_evt_param {
    uint16_t conn_id;
  } connect;
  struct gatts_disconnect_evt_param {
    uint16_t conn_id;
  } disconnect;
} esp_ble_gatts_cb_param_t;

extern "C" {
esp_err_t esp_ble_gatts_send_indicate(esp_gatt_if_t gatts_if, uint16_t conn_id,
                                      uint16_t attr_handle, uint16_t value_len, uint8_t* value,
                                      bool need_confirm);
}

typedef void (*gatts_event_handler)(esp_gatts_cb_event_t event, esp_gatt_if_t gattc_if,
                                    esp_ble_gatts_cb_param_t* param);

class BLECharacteristic;
class BLEServer;

class BLEDescriptor {
 public:
  uint16_t getHandle();
};

class BLE2902 : public BLEDescriptor {};

class BLECharacteristicCallbacks {
 public:
  virtual ~BLECharacteristicCallbacks() {}
  virtual void onWrite(BLECharacteristic* pCharacteristic, esp_ble_gatts_cb_param_t* param);
};

// Without `notify`: it copies the server's map of clients, which the stack's task changes, and no
// lock is around either before version 3.3.
class BLECharacteristic {
 public:
  static const uint32_t PROPERTY_WRITE = 1 << 1;
  static const uint32_t PROPERTY_NOTIFY = 1 << 2;
  static const uint32_t PROPERTY_WRITE_NR = 1 << 5;
  void addDescriptor(BLEDescriptor* pDescriptor);
  uint8_t* getData();
  uint16_t getHandle();
  size_t getLength();
  void setCallbacks(BLECharacteristicCallbacks* pCallbacks);
};

class BLEService {
 public:
  BLECharacteristic* createCharacteristic(const char* uuid, uint32_t properties);
  void start();
};

class BLEServer {
 public:
  BLEService* createService(const char* uuid);
  void disconnect(uint16_t connId);
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
  static void setCustomGattsHandler(gatts_event_handler handler);
  static esp_err_t setMTU(uint16_t mtu);
  static void startAdvertising();
};
