// Stands for libraries/BLE/src/BLEServer.h of the core.

#pragma once

#include "BLEDevice.h"
