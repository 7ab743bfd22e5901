// Stands for components/esp_rom/include/esp_rom_gpio.h of ESP-IDF.

#pragma once

#include <stdint.h>

extern "C" void esp_rom_gpio_connect_out_signal(uint32_t gpio_num, uint32_t signal_idx,
                                                bool out_inv, bool oen_inv);
