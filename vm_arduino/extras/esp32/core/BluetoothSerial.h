// Stands for libraries/BluetoothSerial/src/BluetoothSerial.h of the core.

#pragma once

#include "Arduino.h"

// components/bt/host/bluedroid/api/include/api/esp_spp_api.h
typedef enum {
  ESP_SPP_CLOSE_EVT = 27,
  ESP_SPP_SRV_OPEN_EVT = 34,
} esp_spp_cb_event_t;
typedef enum { ESP_SPP_SUCCESS = 0, ESP_SPP_FAILURE } esp_spp_status_t;
typedef union {
  struct spp_close_evt_param {
    esp_spp_status_t status;
    uint32_t handle;
  } close;
  struct spp_srv_open_evt_param {
    esp_spp_status_t status;
    uint32_t handle;
  } srv_open;
} esp_spp_cb_param_t;
typedef void (*esp_spp_cb_t)(esp_spp_cb_event_t event, esp_spp_cb_param_t* param);

extern "C" esp_err_t esp_spp_disconnect(uint32_t handle);

#if __STDC_HOSTED__
typedef std::function<void(const uint8_t* buffer, size_t size)> BluetoothSerialDataCb;
#else
typedef void (*BluetoothSerialDataCb)(const uint8_t* buffer, size_t size);
#endif

class BluetoothSerial {
 public:
#if ESP_ARDUINO_VERSION_MAJOR >= 3
  bool begin(String localName = String(), bool isMaster = false, bool disableBLE = false);
#else
  bool begin(String localName = String(), bool isMaster = false);
#endif
  bool hasClient();
  void onData(BluetoothSerialDataCb cb);
  esp_err_t register_callback(esp_spp_cb_t callback);
  size_t write(const uint8_t* buffer, size_t size);
};
