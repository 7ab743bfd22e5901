// Stands for libraries/BLE/src/BLE2902.h of the core.

#ifndef TINISCRIPT_CORE_BLE2902_H_
#define TINISCRIPT_CORE_BLE2902_H_

#include "BLEDevice.h"

#endif  // TINISCRIPT_CORE_BLE2902_H_
