// Stands for the configuration of Espressif's core. A build for tests defines the chip.

#pragma once

#if !defined(CONFIG_IDF_TARGET_ESP32) && !defined(CONFIG_IDF_TARGET_ESP32C3)
#define CONFIG_IDF_TARGET_ESP32 1
#endif

#ifdef CONFIG_IDF_TARGET_ESP32
#define CONFIG_BT_SPP_ENABLED 1
#endif
