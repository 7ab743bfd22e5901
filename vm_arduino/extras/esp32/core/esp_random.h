// Stands for components/esp_hw_support/include/esp_random.h of ESP-IDF.

#pragma once

#include <stdint.h>

extern "C" uint32_t esp_random(void);
