// Stands for components/driver/include/driver/gpio.h of ESP-IDF 4.4; 5.1 has it in driver/gpio.

#pragma once

#include <stdint.h>

#include "../esp_err.h"

typedef enum { GPIO_NUM_NC = -1, GPIO_NUM_0 = 0, GPIO_NUM_MAX = 40 } gpio_num_t;

extern "C" {
int gpio_get_level(gpio_num_t gpio_num);
esp_err_t gpio_intr_enable(gpio_num_t gpio_num);
esp_err_t gpio_intr_disable(gpio_num_t gpio_num);
}
