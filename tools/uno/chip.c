// What the chip does around its program: resets and their causes, the watchdog, interrupts that
// stay raised, and the four cycles that entering an interrupt takes.

#include <simavr/avr_watchdog.h>
#include <stddef.h>

#include "uno.h"

enum {
  kMcusr = 0x54,
  kWdtcsr = 0x60,
  kEntryCycles = 4,   // and one more where an address has three bytes
  kChangeCycles = 4,  // for so long a change of the watchdog is allowed
  kWdif = 0x80,
  kWdie = 0x40,
  kWdce = 0x10,
  kWde = 0x08,
};

static unsigned wanted;  // causes of the reset to come
static uint8_t control;
static Cycle changes_until;
static Cycle bites_at;
static struct Asking barking;

// -- registers and interrupts -------------------------------------------------------------------

void take_register(uint16_t address, avr_io_read_t read, avr_io_write_t write) {
  const int io = AVR_DATA_TO_IO(address);
  avr->io[io].r.c = read;
  avr->io[io].r.param = NULL;
  avr->io[io].w.c = write;
  avr->io[io].w.param = NULL;
}

void asking_refresh(struct Asking* asking) {
  if (asking->wants()) {
    if (!asking->vector->pending) avr_raise_interrupt(avr, asking->vector);
  } else if (asking->vector->pending) {
    avr_clear_interrupt(avr, asking->vector);
  }
}

static void asking_runs(struct avr_irq_t* irq, uint32_t value, void* param) {
  (void)irq;
  struct Asking* asking = param;
  if (value && asking->entered) asking->entered();
  if (!value) asking_refresh(asking);
}

void asking_begin(struct Asking* asking, uint8_t vector) {
  for (int k = 0; k < avr->interrupts.vector_count; k++) {
    if (avr->interrupts.vector[k]->vector == vector) asking->vector = avr->interrupts.vector[k];
  }
  if (!asking->vector) give_up("libsimavr has no vector %d", vector);
  avr_irq_register_notify(&asking->vector->irq[AVR_INT_IRQ_RUNNING], asking_runs, asking);
}

void on_interrupts(avr_irq_notify_t notify) {
  for (int k = 0; k < avr->interrupts.vector_count; k++) {
    avr_int_vector_t* vector = avr->interrupts.vector[k];
    avr_irq_register_notify(&vector->irq[AVR_INT_IRQ_RUNNING], notify, vector);
  }
}

static void interrupt_entered(struct avr_irq_t* irq, uint32_t value, void* param) {
  (void)irq;
  (void)param;
  if (value) avr->cycle += avr->address_size == 3 ? kEntryCycles + 1 : kEntryCycles;
}

// -- resets -------------------------------------------------------------------------------------

void reset_soon(enum Cause cause) {
  wanted |= (unsigned)cause;
  interrupt_run();
}

bool reset_is_wanted(void) { return wanted != 0; }

static const char* cause_name(unsigned causes) {
  if (causes & kPowerOn) return "power-on";
  if (causes & kBrownOut) return "brown-out";
  return causes & kExternal ? "external" : "watchdog";
}

static void watchdog_after_reset(uint8_t causes);

bool reset_where_wanted(void) {
  if (!wanted) return false;
  const unsigned causes = wanted;
  wanted = 0;
  uint8_t flags = avr->data[kMcusr];
  const bool is_power_on = causes & kPowerOn;
  flags = is_power_on ? kPowerOn : (uint8_t)(flags | causes);
  avr_reset(avr);
  if (is_power_on) {
    // Nobody knows what is in memory then: not zeros, and the same in each run.
    uint32_t noise = 1;
    for (int k = avr->ioend + 1; k <= avr->ramend; k++) {
      noise = noise * 1664525 + 1013904223;
      avr->data[k] = (uint8_t)(noise >> 24);
    }
  }
  stack_after_reset(is_power_on);
  masked_after_reset();
  avr->data[kMcusr] = flags;
  tell(avr->cycle, "reset", "\"cause\": \"%s\", \"flags\": %d", cause_name(causes), flags);
  queue_after_reset();
  watchdog_after_reset(flags);
  uart_after_reset();
  eeprom_after_reset(is_power_on);
  pins_after_reset();
  return true;
}

// -- the watchdog -------------------------------------------------------------------------------

static Cycle time_out(void) {
  const int scale = (control & 7) | (control >> 2 & 8);
  return ((Cycle)2048 << (scale > 9 ? 9 : scale)) * (kHertz / 1000) / 128;
}

static void bite(Cycle when, void* what);

static void watchdog_restart(void) {
  cancel(bite, NULL);
  if (!(control & (kWde | kWdie))) return;
  bites_at = avr->cycle + time_out();
  at_cycle(bites_at, bite, NULL);
}

// The first time-out asks for the interrupt where it is on. Where nobody has answered it, or it is
// off, the next one resets: interrupts that are off for good do not save a program from it.
static void bite(Cycle when, void* what) {
  (void)what;
  const bool is_asking = (control & kWdie) && !(control & kWdif);
  tell(when, "watchdog", "\"does\": \"%s\"",
       is_asking          ? "interrupt"
       : (control & kWde) ? "reset"
                          : "nothing");
  if (is_asking) {
    control |= kWdif;
    asking_refresh(&barking);
  } else if (control & kWde) {
    reset_soon(kWatchdog);
    return;
  }
  watchdog_restart();
}

static bool barking_wants(void) { return (control & kWdif) && (control & kWdie); }

static void barking_entered(void) {
  control &= (uint8_t)~kWdif;
  if (control & kWde) control &= (uint8_t)~kWdie;
  avr->data[kWdtcsr] = control;
}

static uint8_t control_read(avr_t* chip, avr_io_addr_t address, void* param) {
  (void)param;
  if (chip->cycle >= changes_until) control &= (uint8_t)~kWdce;
  return chip->data[address] = control;
}

static void control_write(avr_t* chip, avr_io_addr_t address, uint8_t value, void* param) {
  (void)param;
  const bool may_change = (control & kWdce) && chip->cycle < changes_until;
  uint8_t next = control & 0x27;  // the time-out
  if (may_change) next = value & 0x27;
  const bool is_kept = (control & kWde) && !may_change;
  const bool is_forced = chip->data[kMcusr] & kWatchdog;
  if ((value & kWde) || is_kept || is_forced) next |= kWde;
  next |= value & kWdie;
  if (!(value & kWdif)) next |= control & kWdif;  // a one clears it
  if ((value & kWdce) && (value & kWde)) {
    next |= kWdce;
    changes_until = chip->cycle + kChangeCycles + 1;
  }
  const bool was_on = control & (kWde | kWdie);
  const bool is_other = (next ^ control) & (kWde | kWdie | 0x27);
  control = next;
  chip->data[address] = control;
  if (is_other) {
    if (may_change || !was_on || !(control & (kWde | kWdie))) watchdog_restart();
    tell(chip->cycle, "watchdog", "\"does\": \"%s\", \"cycles\": %llu",
         !(control & (kWde | kWdie)) ? "off" : "on", (unsigned long long)time_out());
  }
  asking_refresh(&barking);
}

static void watchdog_after_reset(uint8_t causes) {
  cancel(bite, NULL);
  control = causes & kWatchdog ? kWde : 0;  // it stays on, with 16 ms, until MCUSR is cleared
  avr->data[kWdtcsr] = control;
  watchdog_restart();
}

static int on_ioctl(struct avr_io_t* io, uint32_t request, void* param) {
  (void)io;
  (void)param;
  if (request != AVR_IOCTL_WATCHDOG_RESET) return -1;
  watchdog_restart();
  return 0;
}

void chip_begin(void) {
  static avr_io_t own = {.kind = "uno", .ioctl = on_ioctl};
  avr_register_io(avr, &own);
  on_interrupts(interrupt_entered);
  barking = (struct Asking){barking_wants, barking_entered, NULL};
  asking_begin(&barking, board->vectors.watchdog);
  take_register(kWdtcsr, control_read, control_write);
}
