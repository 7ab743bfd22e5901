// Stands for components/soc/CHIP/include/soc/uart_reg.h of ESP-IDF.

#pragma once

#define UART_FRM_ERR_INT_ENA (1 << 3)
