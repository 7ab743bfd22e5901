// Stands for libraries/BLE/src/BLE2902.h of the core.

#pragma once

#include "BLEDevice.h"
