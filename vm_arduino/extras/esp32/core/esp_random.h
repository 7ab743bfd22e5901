// Stands for components/esp_hw_support/include/esp_random.h of ESP-IDF.

#ifndef TINISCRIPT_CORE_ESP_RANDOM_H_
#define TINISCRIPT_CORE_ESP_RANDOM_H_

#include <stdint.h>

extern "C" uint32_t esp_random(void);

#endif  // TINISCRIPT_CORE_ESP_RANDOM_H_
