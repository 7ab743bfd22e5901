// Pins of an ESP32 or ESP32-C3, and PWM on them.
//
// LEDC makes the PWM, and the GPIO matrix joins it to a pin. Off means: the matrix joins the pin to
// its GPIO register, which is low. So a stop does not depend on LEDC.

#pragma once

#include <Arduino.h>
#include <driver/gpio.h>
#include <esp_rom_gpio.h>
#include <freertos/FreeRTOS.h>
#include <soc/gpio_reg.h>
#include <soc/gpio_sig_map.h>
#include <soc/soc.h>
#include <stdint.h>

#define tini_always_inline inline __attribute__((always_inline))

namespace tiniscript {

// A pin has the number that is printed on the board: that of its GPIO.
struct Pin {
  uint8_t number;
};

constexpr Pin kNoPin = {0xff};

// A pin with a channel of LEDC. Two channels that share a timer, 2 n and 2 n + 1, have one
// frequency.
struct Pwm {
  Pin pin;
  uint8_t channel;
};

constexpr uint32_t kPwmHertz = 1000;
constexpr uint8_t kPwmBits = 8;

// A critical section: interrupts of this core are off, and the other core waits. Tasks and
// interrupts may use it, and sections may be nested.
extern portMUX_TYPE critical_mux;

class CriticalSection {
 public:
  CriticalSection() { portENTER_CRITICAL_SAFE(&critical_mux); }
  ~CriticalSection() { portEXIT_CRITICAL_SAFE(&critical_mux); }

 private:
  CriticalSection(const CriticalSection&);
  void operator=(const CriticalSection&);
};

inline bool is_there(Pin pin) { return pin.number != kNoPin.number; }

inline gpio_num_t gpio_of(Pin pin) { return static_cast<gpio_num_t>(pin.number); }

// It uses registers instead of a function, which is in flash and may be out of reach in a panic.
tini_always_inline void write(Pin pin, bool is_high) {
#ifdef GPIO_OUT1_W1TS_REG
  if (pin.number >= 32) {
    const uint32_t bit = 1U << (pin.number - 32);
    REG_WRITE(is_high ? GPIO_OUT1_W1TS_REG : GPIO_OUT1_W1TC_REG, bit);
    return;
  }
#endif
  REG_WRITE(is_high ? GPIO_OUT_W1TS_REG : GPIO_OUT_W1TC_REG, 1U << (pin.number & 31));
}

inline bool is_high(Pin pin) { return gpio_get_level(gpio_of(pin)) != 0; }

inline void begin_output(Pin pin, bool is_high) {
  write(pin, is_high);
  pinMode(pin.number, OUTPUT);
}

inline void begin_input(Pin pin) { pinMode(pin.number, INPUT); }

inline void begin_pull_up(Pin pin) { pinMode(pin.number, INPUT_PULLUP); }

// -- PWM

// The signal of a channel in the GPIO matrix. The Arduino core counts the channels of an ESP32
// through both of its speeds.
constexpr uint32_t signal_of(uint8_t channel) {
#ifdef LEDC_HS_SIG_OUT0_IDX
  return channel < 8 ? LEDC_HS_SIG_OUT0_IDX + static_cast<uint32_t>(channel)
                     : LEDC_LS_SIG_OUT0_IDX + static_cast<uint32_t>(channel - 8);
#else
  return LEDC_LS_SIG_OUT0_IDX + static_cast<uint32_t>(channel);
#endif
}

// Sets the duty cycle, in parts of the channel's range; the full range is constantly high.
inline void write_duty(Pwm pwm, uint32_t duty) {
#if ESP_ARDUINO_VERSION_MAJOR >= 3
  ledcWrite(pwm.pin.number, duty);
#else
  ledcWrite(pwm.channel, duty);
#endif
}

// Joins the channel to its pin.
inline void join(Pwm pwm) {
  esp_rom_gpio_connect_out_signal(pwm.pin.number, signal_of(pwm.channel), false, false);
}

// Sets the pin low, and joins it to its GPIO register: two writes of registers.
tini_always_inline void disconnect_inside(Pwm pwm) {
  write(pwm.pin, false);
  REG_WRITE(GPIO_FUNC0_OUT_SEL_CFG_REG + 4U * pwm.pin.number, SIG_GPIO_OUT_IDX);
}

// Sets up the channel. The pin is low, and stays so until it is connected.
inline void begin_channel(Pwm pwm, uint32_t hertz, uint8_t bits) {
  begin_output(pwm.pin, false);
#if ESP_ARDUINO_VERSION_MAJOR >= 3
  ledcAttachChannel(pwm.pin.number, hertz, bits, pwm.channel);
#else
  ledcSetup(pwm.channel, hertz, bits);
  ledcAttachPin(pwm.pin.number, pwm.channel);
#endif
  disconnect_inside(pwm);
}

inline void begin_pwm(Pwm pwm) { begin_channel(pwm, kPwmHertz, kPwmBits); }

// A servo begins low; `servo_begin` sets up its channel.
inline void hold_servo_pin_low(Pwm servo) { begin_output(servo.pin, false); }

inline void connect_inside(Pwm pwm, uint8_t level) {
  write_duty(pwm, level);
  join(pwm);
}

inline void connect(Pwm pwm, uint8_t level) {
  const CriticalSection critical;
  connect_inside(pwm, level);
}

inline void disconnect(Pwm pwm) {
  const CriticalSection critical;
  disconnect_inside(pwm);
}

}  // namespace tiniscript
