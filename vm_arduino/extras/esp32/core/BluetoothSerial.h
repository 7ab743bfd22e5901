// Stands for libraries/BluetoothSerial/src/BluetoothSerial.h of the core.

#ifndef TINISCRIPT_CORE_BLUETOOTHSERIAL_H_
#define TINISCRIPT_CORE_BLUETOOTHSERIAL_H_

#include "Arduino.h"

class BluetoothSerial {
 public:
#if ESP_ARDUINO_VERSION_MAJOR >= 3
  bool begin(String localName = String(), bool isMaster = false, bool disableBLE = false);
#else
  bool begin(String localName = String(), bool isMaster = false);
#endif
  int available();
  bool hasClient();
  int read();
  size_t write(const uint8_t* buffer, size_t size);
};

#endif  // TINISCRIPT_CORE_BLUETOOTHSERIAL_H_
