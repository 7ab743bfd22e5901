// Stands for libraries/BLE/src/BLEServer.h of the core.

#ifndef TINISCRIPT_CORE_BLESERVER_H_
#define TINISCRIPT_CORE_BLESERVER_H_

#include "BLEDevice.h"

#endif  // TINISCRIPT_CORE_BLESERVER_H_
