// Stands for libraries/WiFi/src/WiFi.h of the core and what it includes.

#pragma once

#include "Arduino.h"

// libraries/WiFi/src/WiFiType.h
typedef enum {
  WL_NO_SHIELD = 255,
  WL_IDLE_STATUS = 0,
  WL_NO_SSID_AVAIL = 1,
  WL_SCAN_COMPLETED = 2,
  WL_CONNECTED = 3,
  WL_CONNECT_FAILED = 4,
  WL_CONNECTION_LOST = 5,
  WL_DISCONNECTED = 6
} wl_status_t;

// components/esp_wifi/include/esp_wifi_types.h
typedef enum { WIFI_MODE_NULL = 0, WIFI_MODE_STA, WIFI_MODE_AP, WIFI_MODE_APSTA } wifi_mode_t;
#define WIFI_OFF WIFI_MODE_NULL
#define WIFI_STA WIFI_MODE_STA
#define WIFI_AP WIFI_MODE_AP

// libraries/WiFi/src/WiFiGeneric.h of version 2, libraries/Network/src/NetworkEvents.h of version 3
typedef enum {
  ARDUINO_EVENT_WIFI_STA_CONNECTED = 4,
  ARDUINO_EVENT_WIFI_STA_DISCONNECTED = 5,
  ARDUINO_EVENT_MAX = 40
} arduino_event_id_t;
typedef struct {
  uint8_t reason;
} wifi_event_sta_disconnected_t;
typedef union {
  wifi_event_sta_disconnected_t wifi_sta_disconnected;
} arduino_event_info_t;
typedef struct {
  arduino_event_id_t event_id;
  arduino_event_info_t event_info;
} arduino_event_t;
typedef void (*WiFiEventSysCb)(arduino_event_t* event);

// cores/esp32/IPAddress.h
class IPAddress {
 public:
  IPAddress(uint8_t first, uint8_t second, uint8_t third, uint8_t fourth);
  uint8_t operator[](int index) const;

 private:
  uint8_t bytes_[4];
};

// The methods are those of WiFiGeneric.h, WiFiSTA.h and WiFiAP.h.
class WiFiClass {
 public:
  wl_status_t begin(const char* ssid, const char* passphrase = nullptr, int32_t channel = 0,
                    const uint8_t* bssid = nullptr, bool connect = true);
  bool disconnect(bool wifioff = false, bool eraseap = false);
  IPAddress localIP();
  int onEvent(WiFiEventSysCb cbEvent, arduino_event_id_t event = ARDUINO_EVENT_MAX);
  static bool mode(wifi_mode_t m);
  static void persistent(bool persistent);
  bool reconnect();
  bool setAutoReconnect(bool autoReconnect);
  static bool setHostname(const char* hostname);
  bool setSleep(bool enabled);
  bool softAP(const char* ssid, const char* passphrase = nullptr, int channel = 1,
              int ssid_hidden = 0, int max_connection = 4, bool ftm_responder = false);
  bool softAPdisconnect(bool wifioff = false);
  IPAddress softAPIP();
  static wl_status_t status();
};

extern WiFiClass WiFi;
