// Stands for libraries/ESPmDNS/src/ESPmDNS.h of the core.

#pragma once

#include "Arduino.h"

class MDNSResponder {
 public:
#if ESP_ARDUINO_VERSION_MAJOR >= 3
  bool begin(const String& hostName);
  void setInstanceName(const String& name);
#else
  bool begin(const char* hostName);
  void setInstanceName(String name);
#endif
  bool addService(const char* service, const char* proto, uint16_t port);
  void end();
};

extern MDNSResponder MDNS;
