// Stands for components/soc/CHIP/include/soc/uart_reg.h of ESP-IDF.

#ifndef TINISCRIPT_SOC_UART_REG_H_
#define TINISCRIPT_SOC_UART_REG_H_

#define UART_FRM_ERR_INT_ENA (1 << 3)

#endif  // TINISCRIPT_SOC_UART_REG_H_
