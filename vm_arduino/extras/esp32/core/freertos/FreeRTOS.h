// Stands for components/freertos/port/CHIP/include/freertos/portmacro.h of ESP-IDF.

#pragma once

#include <stdint.h>

#include "../sdkconfig.h"

// In 4.4 and 5.1 a struct with the core that has the lock and how often it took it.
typedef struct {
  uint32_t owner;
  uint32_t count;
} portMUX_TYPE;

#ifdef CONFIG_IDF_TARGET_ESP32
#define portNUM_PROCESSORS 2
#else
#define portNUM_PROCESSORS 1
#endif

#define portMUX_INITIALIZER_UNLOCKED {0xb33fffff, 0}

extern "C" {
void simulated_enter_critical(portMUX_TYPE* mux);
void simulated_exit_critical(portMUX_TYPE* mux);
}

#define portENTER_CRITICAL_SAFE(mux) simulated_enter_critical(mux)
#define portEXIT_CRITICAL_SAFE(mux) simulated_exit_critical(mux)
