// Stands for the Arduino core of an ESP32: only what the firmware calls, with the signatures of
// versions 2 and 3. `simulated_chip.cpp` does what they say.
//
// Each row names the file of the core or of ESP-IDF that declares it. `../signatures.cpp` pins
// them.

#pragma once

#include <stddef.h>
#include <stdint.h>

#if __STDC_HOSTED__
#include <functional>
#endif

#include "driver/gpio.h"
#include "esp_attr.h"
#include "esp_system.h"
#include "freertos/FreeRTOS.h"
#include "sdkconfig.h"

// cores/esp32/esp_arduino_version.h
#ifndef ESP_ARDUINO_VERSION_MAJOR
#define ESP_ARDUINO_VERSION_MAJOR 2
#endif

// cores/esp32/esp32-hal-gpio.h
#define LOW 0x0
#define HIGH 0x1
#define INPUT 0x01
#define OUTPUT 0x03
#define INPUT_PULLUP 0x05
#define RISING 0x01
#define FALLING 0x02
#define CHANGE 0x03

extern "C" {

// cores/esp32/esp32-hal-gpio.h
void pinMode(uint8_t pin, uint8_t mode);
void attachInterrupt(uint8_t pin, void (*handler)(void), int mode);

// cores/esp32/esp32-hal-adc.h
uint16_t analogRead(uint8_t pin);
void analogReadResolution(uint8_t bits);

// cores/esp32/esp32-hal.h
unsigned long millis();
unsigned long micros();

// cores/esp32/esp32-hal-misc.c, weak there
void initVariant();

#if ESP_ARDUINO_VERSION_MAJOR >= 3
// cores/esp32/esp32-hal.h
typedef struct {
  int core;
  const char* reason;
} arduino_panic_info_t;
typedef void (*arduino_panic_handler_t)(arduino_panic_info_t* info, void* arg);
void set_arduino_panic_handler(arduino_panic_handler_t handler, void* arg);
#endif

// cores/esp32/esp32-hal-ledc.h
#if ESP_ARDUINO_VERSION_MAJOR >= 3
// Since 3.1 the channel is an int8_t; a number from 0 to 15 is right for both.
bool ledcAttachChannel(uint8_t pin, uint32_t freq, uint8_t resolution, uint8_t channel);
bool ledcWrite(uint8_t pin, uint32_t duty);
uint32_t ledcWriteTone(uint8_t pin, uint32_t freq);
uint32_t ledcChangeFrequency(uint8_t pin, uint32_t freq, uint8_t resolution);
#else
uint32_t ledcSetup(uint8_t channel, uint32_t freq, uint8_t resolution_bits);
void ledcAttachPin(uint8_t pin, uint8_t channel);
void ledcWrite(uint8_t channel, uint32_t duty);
uint32_t ledcWriteTone(uint8_t channel, uint32_t freq);
#endif

}  // extern "C"

// cores/esp32/Arduino.h
void setup();
void loop();

// cores/esp32/WString.h
class String {
 public:
  String(const char* cstr = "");
  ~String();
  String(const String& str);
  const char* c_str() const;

 private:
  char* text_;
};

// cores/esp32/HardwareSerial.h
#if ESP_ARDUINO_VERSION_MAJOR >= 3
typedef enum {
  UART_NO_ERROR,
  UART_BREAK_ERROR,
  UART_BUFFER_FULL_ERROR,
  UART_FIFO_OVF_ERROR,
  UART_FRAME_ERROR,
  UART_PARITY_ERROR
} hardwareSerial_error_t;
#else
typedef enum {
  UART_BREAK_ERROR,
  UART_BUFFER_FULL_ERROR,
  UART_FIFO_OVF_ERROR,
  UART_FRAME_ERROR,
  UART_PARITY_ERROR
} hardwareSerial_error_t;
#endif

#if __STDC_HOSTED__
typedef std::function<void(hardwareSerial_error_t)> OnReceiveErrorCb;
#else
typedef void (*OnReceiveErrorCb)(hardwareSerial_error_t);  // a compiler without its library
#endif

#define SERIAL_8N1 0x800001c

class HardwareSerial {
 public:
  void begin(unsigned long baud, uint32_t config = SERIAL_8N1, int8_t rxPin = -1, int8_t txPin = -1,
             bool invert = false, unsigned long timeout_ms = 20000UL,
             uint8_t rxfifo_full_thrhd = 112);
  void onReceiveError(OnReceiveErrorCb function);
  size_t setRxBufferSize(size_t new_size);
  size_t setTxBufferSize(size_t new_size);
  int available();
  int availableForWrite();
  int read();
  size_t write(uint8_t byte);
};

// cores/esp32/Esp.h
class EspClass {
 public:
  uint64_t getEfuseMac();
};

extern EspClass ESP;

#ifdef ARDUINO_USB_CDC_ON_BOOT
// cores/esp32/HWCDC.h: the USB of an ESP32-C3 itself
class HWCDC {
 public:
  void begin(unsigned long baud = 0);
  size_t setRxBufferSize(size_t);
  size_t setTxBufferSize(size_t);
  void setTxTimeoutMs(uint32_t timeout);
  int available();
  int availableForWrite();
  int read();
  size_t write(uint8_t);
};

extern HWCDC Serial;
#else
extern HardwareSerial Serial;
#endif
