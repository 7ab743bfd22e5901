// Stands for components/soc/CHIP/include/soc/gpio_sig_map.h of ESP-IDF.

#pragma once

#include "../sdkconfig.h"

#ifdef CONFIG_IDF_TARGET_ESP32
#define LEDC_HS_SIG_OUT0_IDX 71
#define LEDC_LS_SIG_OUT0_IDX 79
#define SIG_GPIO_OUT_IDX 256
#else
#define LEDC_LS_SIG_OUT0_IDX 45
#define SIG_GPIO_OUT_IDX 128
#endif
