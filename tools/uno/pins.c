// The pins as they are named on the board: what the chip does with them, and what drives them.
//
// Whether a timer drives a pin is read from its registers: libsimavr 1.6 makes no edges for the
// phase-correct modes that Arduino gives to timers 1 and 2.

#include <simavr/avr_adc.h>
#include <simavr/avr_extint.h>
#include <simavr/avr_ioport.h>
#include <stdio.h>
#include <string.h>

#include "uno.h"

enum {
  kUsualMilliVolts = 5000,
  kBandGapMilliVolts = 1100,
  kBandGapCycles = kHertz / 1000,  // for so long it is not what it should be
  kAdmux = 0x7c,
  kMaxCount = 1023,
  kMaxAnalog = 16,
  kName = 4,
};

// -- timers: which registers, which pins --------------------------------------------------------

struct Register {
  const char* name;
  uint16_t address;
  bool is_wide;
  int timer;
  int told;
};

// Of timers with 16 bits an Uno has number 1 alone, and no channel C.
// clang-format off
static struct Register registers[] = {
    {"TCCR0A", 0x44, false, 0, 0}, {"TCCR0B", 0x45, false, 0, 0},
    {"OCR0A", 0x47, false, 0, 0}, {"OCR0B", 0x48, false, 0, 0},
    {"TCCR1A", 0x80, false, 1, 0}, {"TCCR1B", 0x81, false, 1, 0}, {"ICR1", 0x86, true, 1, 0},
    {"OCR1A", 0x88, true, 1, 0}, {"OCR1B", 0x8a, true, 1, 0},
    {"TCCR2A", 0xb0, false, 2, 0}, {"TCCR2B", 0xb1, false, 2, 0},
    {"OCR2A", 0xb3, false, 2, 0}, {"OCR2B", 0xb4, false, 2, 0},
    {"OCR1C", 0x8c, true, 3, 0},
    {"TCCR3A", 0x90, false, 3, 0}, {"TCCR3B", 0x91, false, 3, 0}, {"ICR3", 0x96, true, 3, 0},
    {"OCR3A", 0x98, true, 3, 0}, {"OCR3B", 0x9a, true, 3, 0}, {"OCR3C", 0x9c, true, 3, 0},
    {"TCCR4A", 0xa0, false, 4, 0}, {"TCCR4B", 0xa1, false, 4, 0}, {"ICR4", 0xa6, true, 4, 0},
    {"OCR4A", 0xa8, true, 4, 0}, {"OCR4B", 0xaa, true, 4, 0}, {"OCR4C", 0xac, true, 4, 0},
    {"TCCR5A", 0x120, false, 5, 0}, {"TCCR5B", 0x121, false, 5, 0}, {"ICR5", 0x126, true, 5, 0},
    {"OCR5A", 0x128, true, 5, 0}, {"OCR5B", 0x12a, true, 5, 0}, {"OCR5C", 0x12c, true, 5, 0},
};
enum { kRegisters = sizeof registers / sizeof *registers };

static const uint16_t controls[] = {0x44, 0x80, 0xb0, 0x90, 0xa0, 0x120};
static const int divisors[] = {0, 1, 8, 64, 256, 1024, 0, 0};
static const int divisors_2[] = {0, 1, 8, 32, 64, 128, 256, 1024};

// Each port: PINx, DDRx, PORTx follow each other.
static const struct Port {
  char letter;
  uint16_t address;
} ports[] = {
    {'A', 0x20}, {'B', 0x23}, {'C', 0x26}, {'D', 0x29}, {'E', 0x2c}, {'F', 0x2f}, {'G', 0x32},
    {'H', 0x100}, {'J', 0x103}, {'K', 0x106}, {'L', 0x109},
};
enum { kPorts = sizeof ports / sizeof *ports };
// clang-format on

static bool is_wide_timer(int timer) { return timer != 0 && timer != 2; }

static uint16_t compare_of(int timer, int channel) {
  const int from = controls[timer] + (is_wide_timer(timer) ? 8 + 2 * channel : 3 + channel);
  return (uint16_t)from;
}

static int byte_at(uint16_t address) { return avr->data[address]; }

static int word_at(uint16_t address, bool is_wide) {
  return byte_at(address) | (is_wide ? byte_at((uint16_t)(address + 1)) << 8 : 0);
}

// Where an output's two bits are in the first register of its timer.
static int shift_of(const struct Output* output) { return 6 - 2 * output->channel; }

struct Wave {
  int value;
  double duty;
  double hertz;
};

// Returns what an output does, for a timer that drives its pin.
static struct Wave wave_of(const struct Output* output) {
  const bool is_wide = is_wide_timer(output->timer);
  const int a = byte_at(controls[output->timer]);
  const int b = byte_at((uint16_t)(controls[output->timer] + 1));
  const int mode = (a & 3) | (is_wide ? b >> 1 & 12 : b >> 1 & 4);
  const int divisor = (output->timer == 2 ? divisors_2 : divisors)[b & 7];
  const int by_compare = word_at(compare_of(output->timer, 0), is_wide);
  const int by_capture = word_at((uint16_t)(controls[output->timer] + 6), true);
  bool is_fast;
  bool is_plain;  // counts up and begins again: the pin toggles, or changes once
  int top;
  if (is_wide) {
    static const int tops[] = {65535, 255, 511, 1023};
    is_plain = mode == 0 || mode == 4 || mode == 12;
    is_fast = (mode >= 5 && mode <= 7) || mode >= 14;
    top = mode < 8 ? tops[mode & 3] : mode & 1 ? by_compare : by_capture;
    if (mode == 4) top = by_compare;
  } else {
    is_plain = mode == 0 || mode == 2;
    is_fast = mode == 3 || mode == 7;
    top = mode == 2 || mode >= 5 ? by_compare : 255;
  }
  const int bits = a >> shift_of(output) & 3;
  const int value = word_at(compare_of(output->timer, output->channel), is_wide);
  struct Wave wave = {value, 0.5, 0};
  const double counts = is_fast || is_plain ? top + 1.0 : 2.0 * top;
  if (divisor && counts > 0) wave.hertz = kHertz / (divisor * counts);
  if (bits == 1 || is_plain) {
    wave.hertz /= 2;
    return wave;
  }
  if (top > 0) wave.duty = is_fast ? (value + 1.0) / (top + 1.0) : (double)value / top;
  if (wave.duty > 1) wave.duty = 1;
  if (bits == 3) wave.duty = 1 - wave.duty;
  return wave;
}

static const struct Output* output_of(int pin) {
  for (unsigned k = 0; k < board->output_count; k++) {
    const struct Output* output = &board->outputs[k];
    if (output->pin != pin) continue;
    if (byte_at(controls[output->timer]) >> shift_of(output) & 3) return output;
  }
  return NULL;
}

// -- pins ---------------------------------------------------------------------------------------

static struct Pin {
  char name[kName];
  avr_irq_t* irq;
  const struct Port* port;
  int bit;
  const char* is;
  struct Wave wave;
  bool level;
  enum Drive drive;
} pins[kMaxPins];
static int pin_count;
static int analog[kMaxAnalog];
static int supply_mv = kUsualMilliVolts;
static avr_adc_mux_t* band_gap;
static int mux;  // where ADMUX was
static int watched_pin = kNoPin;
static char watched_state[8];

int pin_number(const char* name) {
  for (int pin = 0; pin < pin_count; pin++) {
    if (!strcmp(name, pins[pin].name)) return pin;
  }
  return kNoPin;
}

static bool is_same(const struct Wave* one, const struct Wave* other) {
  return one->value == other->value && !(one->duty < other->duty || one->duty > other->duty) &&
         !(one->hertz < other->hertz || one->hertz > other->hertz);
}

static void refresh(int number) {
  struct Pin* pin = &pins[number];
  const struct Port* port = pins[number].port;
  const bool is_output = byte_at((uint16_t)(port->address + 1)) >> pins[number].bit & 1;
  const bool is_set = byte_at((uint16_t)(port->address + 2)) >> pins[number].bit & 1;
  const struct Output* output = is_output ? output_of(number) : NULL;
  const char* is = is_output ? (is_set ? "high" : "low") : is_set ? "pullup" : "input";
  struct Wave wave = {0, 0, 0};
  if (output) {
    is = "pwm";
    wave = wave_of(output);
  }
  if (is == pin->is && is_same(&wave, &pin->wave)) return;
  const Cycle now = avr->cycle;
  const bool was_high = pin->level;
  pin->is = is;
  pin->wave = wave;
  pin->level = is_output && is_set;
  if (output) {
    tell(now, "pin",
         "\"pin\": \"%s\", \"is\": \"pwm\", \"value\": %d, \"duty\": %.5f, \"hz\": %.3f",
         pins[number].name, wave.value, wave.duty, wave.hertz);
  } else {
    tell(now, "pin", "\"pin\": \"%s\", \"is\": \"%s\"", pins[number].name, is);
  }
  if (pin->level != was_high) sonar_trigger(now, number, pin->level);
  if (watched_pin == number && !strcmp(watched_state, is)) {
    watched_pin = kNoPin;
    pause_run("pin");
  }
}

static void refresh_all(void) {
  for (int pin = 0; pin < pin_count; pin++) refresh(pin);
}

void pins_watch(int pin, const char* state) {
  watched_pin = pin;
  strncpy(watched_state, state, sizeof watched_state - 1);
}

static void port_written(struct avr_irq_t* irq, uint32_t value, void* param) {
  (void)irq;
  (void)value;
  for (int pin = 0; pin < pin_count; pin++) {
    if (pins[pin].port == param) refresh(pin);
  }
}

static void timer_written(struct avr_irq_t* irq, uint32_t value, void* param) {
  (void)irq;
  (void)value;
  struct Register* written = param;
  const int is = word_at(written->address, written->is_wide);
  if (is == written->told) return;
  written->told = is;
  tell(avr->cycle, "register", "\"register\": \"%s\", \"value\": %d", written->name, is);
  for (unsigned k = 0; k < board->output_count; k++) refresh(board->outputs[k].pin);
}

// -- what drives them ---------------------------------------------------------------------------

static void apply_drive(int number) {
  const struct Port* port = pins[number].port;
  unsigned mask = 0, value = 0;
  for (int pin = 0; pin < pin_count; pin++) {
    if (pins[pin].port != port || pins[pin].drive == kReleased) continue;
    mask |= 1u << pins[pin].bit;
    value |= (unsigned)(pins[pin].drive == kHigh) << pins[pin].bit;
  }
  struct avr_ioport_external_t external = {.mask = mask & 0xff, .value = value & 0xff};
  avr_ioctl(avr, (uint32_t)AVR_IOCTL_IOPORT_SET_EXTERNAL(port->letter), &external);
  if (byte_at((uint16_t)(port->address + 1)) >> pins[number].bit & 1) return;  // the chip drives it
  const bool is_pulled = byte_at((uint16_t)(port->address + 2)) >> pins[number].bit & 1;
  const bool level = pins[number].drive == kReleased ? is_pulled : pins[number].drive == kHigh;
  avr_raise_irq(pins[number].irq, level);
}

void pin_drive(int number, enum Drive drive) {
  static const char* const drives[] = {"nothing", "low", "high"};
  pins[number].drive = drive;
  tell(avr->cycle, "drive", "\"pin\": \"%s\", \"by\": \"%s\"", pins[number].name,
       drives[drive + 1]);
  apply_drive(number);
}

void pin_wire(bool level) {
  pins[kReceivePin].drive = level ? kHigh : kLow;
  apply_drive(kReceivePin);
}

void analog_set(int channel, int count) {
  if (channel < 0 || channel >= board->analog_pins || count < 0 || count > kMaxCount) return;
  analog[channel] = count;
  avr_irq_t* irq = avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_ADC0 + channel);
  const int rounded_up = (count * supply_mv + kMaxCount - 1) / kMaxCount;
  avr_raise_irq(irq, (uint32_t)rounded_up);  // the chip rounds down
}

// What is read as a count is a part of the supply, and stays that part.
void supply_set(int millivolts) {
  supply_mv = millivolts;
  avr->vcc = avr->avcc = avr->aref = (uint32_t)millivolts;
  for (int channel = 0; channel < board->analog_pins; channel++)
    analog_set(channel, analog[channel]);
}

static void band_gap_settled(Cycle when, void* what) {
  (void)when;
  (void)what;
  band_gap->src = kBandGapMilliVolts;
}

// The band gap is a weak source: after a change of the channel it has to load the converter first,
// which still holds next to nothing.
static void mux_written(struct avr_irq_t* irq, uint32_t value, void* param) {
  (void)irq;
  (void)param;
  const int now = (int)value & 0x1f;
  if (now == mux) return;
  mux = now;
  band_gap->src = 0;
  cancel(band_gap_settled, NULL);
  at_cycle(avr->cycle + kBandGapCycles, band_gap_settled, NULL);
}

static void band_gap_begin(void) {
  for (avr_io_t* part = avr->io_port; part; part = part->next) {
    if (strcmp(part->kind, "adc") != 0) continue;
    avr_adc_t* adc = (avr_adc_t*)part;
    for (int k = 0; k < 32; k++) {
      if (adc->muxmode[k].kind == ADC_MUX_REF && adc->muxmode[k].src == kBandGapMilliVolts)
        band_gap = &adc->muxmode[k];
    }
  }
  if (!band_gap) give_up("libsimavr has no band gap");
}

// Where a low level asks for an interrupt again and again, libsimavr looks at the pin all the time,
// also while nobody wants that interrupt: ten times slower. So it asks once.
static void levels_ask_once(void) {
  for (uint8_t number = 0; number < board->external_interrupts; number++) {
    avr_extint_set_strict_lvl_trig(avr, number, 0);
  }
}

void pins_after_reset(void) {
  levels_ask_once();  // a reset has forgotten it
  for (int k = 0; k < kRegisters; k++) {
    if (registers[k].timer < board->timers) timer_written(NULL, 0, &registers[k]);
  }
  for (int pin = 0; pin < pin_count; pin++) {
    pins[pin].irq->value = 0;  // as the registers now say
    apply_drive(pin);
  }
  for (int channel = 0; channel < board->analog_pins; channel++)
    analog_set(channel, analog[channel]);
  refresh_all();
}

static void listen(uint16_t address, avr_irq_notify_t notify, const void* param) {
  avr_irq_t* irq = avr_iomem_getirq(avr, address, NULL, AVR_IOMEM_IRQ_ALL);
  avr_irq_register_notify(irq, notify, (void*)(uintptr_t)param);
}

static void pin_begin(int number) {
  struct Pin* pin = &pins[number];
  const char* place = board->places + 2 * number;
  const bool is_analog = number >= board->digital_pins;
  const int shown = is_analog ? number - board->digital_pins : number;
  snprintf(pin->name, kName, "%c%d", is_analog ? 'A' : 'D', shown % 100);
  pin->port = ports;
  while (pin->port->letter != place[0]) pin->port++;
  pin->bit = place[1] - '0';
  pin->irq = avr_io_getirq(avr, (uint32_t)AVR_IOCTL_IOPORT_GETIRQ(place[0]), pin->bit);
  pin->drive = kReleased;
  pin->is = "";
}

void pins_begin(void) {
  band_gap_begin();
  pin_count = board->digital_pins + board->analog_pins;
  for (int pin = 0; pin < pin_count; pin++) pin_begin(pin);
  for (int k = 0; k < kPorts; k++) {
    if (!strchr(board->places, ports[k].letter)) continue;
    for (uint16_t each = 0; each < 3; each++) {
      listen((uint16_t)(ports[k].address + each), port_written, &ports[k]);
    }
  }
  for (int k = 0; k < kRegisters; k++) {
    if (registers[k].timer >= board->timers) continue;
    listen(registers[k].address, timer_written, &registers[k]);
  }
  listen(kAdmux, mux_written, NULL);
}
