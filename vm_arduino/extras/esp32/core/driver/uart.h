// Stands for components/driver/include/driver/uart.h of ESP-IDF 4.4; 5.1 has it in driver/uart.

#pragma once

#include <stdint.h>

#include "../esp_err.h"

typedef int uart_port_t;
#define UART_NUM_0 0

extern "C" {
esp_err_t uart_enable_intr_mask(uart_port_t uart_num, uint32_t enable_mask);
}
