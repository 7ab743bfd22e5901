// Stands for components/soc/CHIP/include/soc/soc.h of ESP-IDF.

#pragma once

#include <stdint.h>

extern "C" void simulated_register(uint32_t at, uint32_t value);

#define REG_WRITE(_r, _v) simulated_register(_r, _v)
