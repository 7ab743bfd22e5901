// Pins of an ATmega328P or ATmega2560, and PWM on them, by direct register access.
//
// With pins known at compile time, most of this compiles to one instruction. A change of a register
// that an interrupt also changes runs with interrupts off: the interrupt that turns the motors off
// may come at any time, and its write must not be undone.

#pragma once

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stdint.h>

// Marks a function that is always inlined.
#define tini_always_inline inline __attribute__((always_inline))

namespace tiniscript {

// The addresses of PORTA to PORTL. The DDR and PIN registers lie just before each.
enum Port : uint16_t {
  kPortA = 0x22,
  kPortB = 0x25,
  kPortC = 0x28,
  kPortD = 0x2b,
  kPortE = 0x2e,
  kPortF = 0x31,
  kPortG = 0x34,
  kPortH = 0x102,
  kPortJ = 0x105,
  kPortK = 0x108,
  kPortL = 0x10b,
};

struct Pin {
  uint16_t port;
  uint8_t mask;
};

constexpr Pin kNoPin = {0, 0};

enum Channel : uint8_t { kChannelA, kChannelB, kChannelC };

// A PWM pin: OC0B is timer 0, channel B. The timers run with 8 bits.
struct Pwm {
  Pin pin;
  uint8_t timer;
  uint8_t channel;
};

// A critical section: interrupts are off during the object's lifetime.
class CriticalSection {
 public:
  tini_always_inline CriticalSection() : saved_sreg_(SREG) { cli(); }
  tini_always_inline ~CriticalSection() {
    asm volatile("" ::: "memory");  // compiler barrier: no access moves out of the section
    SREG = saved_sreg_;
  }

 private:
  CriticalSection(const CriticalSection&);
  void operator=(const CriticalSection&);

  uint8_t saved_sreg_;
};

tini_always_inline volatile uint8_t& register8(uint16_t address) {
  return *reinterpret_cast<volatile uint8_t*>(address);
}

tini_always_inline volatile uint16_t& register16(uint16_t address) {
  return *reinterpret_cast<volatile uint16_t*>(address);
}

// Whether a bit there can be changed with one instruction, which no interrupt can split.
tini_always_inline bool is_near(uint16_t address) {
  return __builtin_constant_p(address) && address < 0x40;
}

tini_always_inline void set_bits(uint16_t address, uint8_t mask) {
  if (is_near(address)) {
    register8(address) |= mask;
  } else {
    const CriticalSection critical;
    register8(address) |= mask;
  }
}

tini_always_inline void clear_bits(uint16_t address, uint8_t mask) {
  if (is_near(address)) {
    register8(address) &= static_cast<uint8_t>(~mask);
  } else {
    const CriticalSection critical;
    register8(address) &= static_cast<uint8_t>(~mask);
  }
}

constexpr bool is_there(Pin pin) { return pin.port != 0; }

tini_always_inline void write(Pin pin, bool is_high) {
  if (is_high) {
    set_bits(pin.port, pin.mask);
  } else {
    clear_bits(pin.port, pin.mask);
  }
}

tini_always_inline void toggle(Pin pin) {
  register8(static_cast<uint16_t>(pin.port - 2)) = pin.mask;
}

tini_always_inline bool is_high(Pin pin) {
  return (register8(static_cast<uint16_t>(pin.port - 2)) & pin.mask) != 0;
}

tini_always_inline void begin_output(Pin pin, bool is_high) {
  write(pin, is_high);
  set_bits(static_cast<uint16_t>(pin.port - 1), pin.mask);
}

// Pins are inputs after a reset.
tini_always_inline void begin_pull_up(Pin pin) { write(pin, true); }

// A servo begins low.
tini_always_inline void hold_servo_pin_low(Pin pin) { begin_output(pin, false); }

// -- PWM

constexpr Pwm kNoPwm = {kNoPin, 0, kChannelA};

constexpr uint16_t control_of(Pwm pwm) {
  return pwm.timer == 0   ? 0x44
         : pwm.timer == 1 ? 0x80
         : pwm.timer == 2 ? 0xb0
         : pwm.timer == 3 ? 0x90
         : pwm.timer == 4 ? 0xa0
                          : 0x120;
}

constexpr bool has_8_bits(Pwm pwm) { return pwm.timer == 0 || pwm.timer == 2; }

constexpr uint16_t compare_of(Pwm pwm) {
  return static_cast<uint16_t>(control_of(pwm) +
                               (has_8_bits(pwm) ? 3 + pwm.channel : 8 + 2 * pwm.channel));
}

// The COM bit that connects a channel to its pin.
constexpr uint8_t connection_of(Pwm pwm) { return static_cast<uint8_t>(0x80 >> 2 * pwm.channel); }

// Sets the pin low; the timer runs already.
tini_always_inline void begin_pwm(Pwm pwm) { begin_output(pwm.pin, false); }

// Lets a timer drive a pin; 255 is constantly high. For callers with interrupts off: they change
// these registers too, and 16-bit timers share one for the high byte.
tini_always_inline void connect_inside(Pwm pwm, uint8_t level) {
  if (has_8_bits(pwm)) {
    register8(compare_of(pwm)) = level;
  } else {
    register16(compare_of(pwm)) = level;
  }
  register8(control_of(pwm)) |= connection_of(pwm);
}

// Disconnects the timer and sets the pin low. For callers with interrupts off.
tini_always_inline void disconnect_inside(Pwm pwm) {
  register8(control_of(pwm)) &= static_cast<uint8_t>(~connection_of(pwm));
  write(pwm.pin, false);
}

// The same for any caller.
tini_always_inline void connect(Pwm pwm, uint8_t level) {
  const CriticalSection critical;
  connect_inside(pwm, level);
}

tini_always_inline void disconnect(Pwm pwm) {
  const CriticalSection critical;
  disconnect_inside(pwm);
}

}  // namespace tiniscript
