// Stands for components/esp_rom/include/esp_rom_gpio.h of ESP-IDF.

#ifndef TINISCRIPT_CORE_ESP_ROM_GPIO_H_
#define TINISCRIPT_CORE_ESP_ROM_GPIO_H_

#include <stdint.h>

extern "C" void esp_rom_gpio_connect_out_signal(uint32_t gpio_num, uint32_t signal_idx,
                                                bool out_inv, bool oen_inv);

#endif  // TINISCRIPT_CORE_ESP_ROM_GPIO_H_
