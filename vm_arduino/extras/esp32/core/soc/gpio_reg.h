// Stands for components/soc/CHIP/include/soc/gpio_reg.h of ESP-IDF.

#pragma once

#include "../sdkconfig.h"

#ifdef CONFIG_IDF_TARGET_ESP32
#define DR_REG_GPIO_BASE 0x3ff44000
#define GPIO_OUT1_W1TS_REG (DR_REG_GPIO_BASE + 0x14)
#define GPIO_OUT1_W1TC_REG (DR_REG_GPIO_BASE + 0x18)
#define GPIO_FUNC0_OUT_SEL_CFG_REG (DR_REG_GPIO_BASE + 0x530)
#else
#define DR_REG_GPIO_BASE 0x60004000
#define GPIO_FUNC0_OUT_SEL_CFG_REG (DR_REG_GPIO_BASE + 0x554)
#endif
#define GPIO_OUT_W1TS_REG (DR_REG_GPIO_BASE + 0x8)
#define GPIO_OUT_W1TC_REG (DR_REG_GPIO_BASE + 0xc)
