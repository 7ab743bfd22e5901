// Stands for components/mbedtls/mbedtls/include/mbedtls/version.h of ESP-IDF 4.4 and 5.1.

#pragma once

#if __STDC_HOSTED__ && __has_include_next(<mbedtls/version.h>)
#include_next <mbedtls/version.h>
#elif ESP_ARDUINO_VERSION_MAJOR >= 3
#define MBEDTLS_VERSION_NUMBER 0x03050000
#else
#define MBEDTLS_VERSION_NUMBER 0x021C0000
#endif
