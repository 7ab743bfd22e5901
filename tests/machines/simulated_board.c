/* Runs a sketch on a simulated chip, and prints each change of the registers that are watched.
 *
 *   simulated_board firmware.elf atmega328p CYCLES < script
 *
 * Lines of the script (numbers are decimal; a port is a letter):
 *   watch ADDRESS                    a byte of data memory
 *   pin CYCLE PORT BIT LEVEL         what a wire from outside does
 *   adc CHANNEL MILLIVOLTS
 *   next CHANNEL MILLIVOLTS          what a conversion of that channel finds: every line is one
 *   uart                             prints `CYCLE UART BYTE` for what the chip sends
 *   ping PORT BIT PORT BIT DELAY WIDTH AT SPAN
 *       an HC-SR04: its trigger and its echo; the echo of the next ping begins so many cycles
 *       after the trigger falls, and is so long. Every line is a ping of that trigger; its last one
 *       repeats. A trigger that falls while the echo is high is not seen. AT cycles after the
 *       trigger falls the wire says the opposite for SPAN cycles.
 *
 *   sweep STEP COUNT SPAN PORT BIT
 *       when the run has ended, COUNT copies of the chip go on: in the first one that wire goes
 *       high at once, in each other one STEP cycles later; SPAN cycles later the copy ends
 *
 * Prints `CYCLE ADDRESS VALUE` for each change, and `CYCLE END QUIET` at the end: for how many
 * cycles interrupts were off at most, from the first time that they were on. A copy prints
 * `COPY NUMBER` and what its watched registers are in the end.
 */
#include <simavr/avr_adc.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOST = 256, MAX_CHANGES = 1 << 14 };

static avr_t* avr;

static struct watch {
  unsigned address, value;
} watches[MOST];
static int watch_count;

/* A wire to a pin. The chip's own pull-up does not move it: so simavr has to be told. */
struct wire {
  char port;
  int bit;
};

static struct change {
  unsigned long long cycle;
  struct wire wire;
  int level;
} changes[MAX_CHANGES];
static int change_count;

static struct ping {
  struct wire trigger, echo;
  unsigned long long delay, width, at, span;
  int is_done, is_high, is_glitched;
} pings[MOST];
static int ping_count;

/* A sensor: its trigger, and whether its echo is on its way or high. */
static struct sonar {
  struct wire trigger;
  unsigned long long rose;
  int was_high, is_busy;
} sonars[8];
static int sonar_count;

static struct {
  unsigned step, count, span;
  struct wire wire;
} sweep;
static int is_copy;

static struct conversion {
  int channel, millivolts, is_done;
} conversions[MOST];
static int conversion_count;

static unsigned long long since, quiet; /* how long interrupts are off */

static avr_irq_t* pin_of(struct wire wire) {
  return avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(wire.port), wire.bit);
}

static void drive(struct wire wire, int level) {
  static avr_ioport_external_t wires[128];
  avr_ioport_external_t* const all = &wires[(int)wire.port];
  const unsigned bit = 1u << wire.bit;
  all->name = wire.port;
  all->mask |= bit;
  all->value = level ? all->value | bit : all->value & ~bit;
  avr_ioctl(avr, AVR_IOCTL_IOPORT_SET_EXTERNAL(wire.port), all);
  avr_raise_irq(pin_of(wire), level);
}

static int is_same(struct wire a, struct wire b) { return a.port == b.port && a.bit == b.bit; }

static struct sonar* sonar_of(struct wire trigger) {
  struct sonar* sonar = sonars;
  while (sonar < sonars + sonar_count && !is_same(sonar->trigger, trigger)) sonar++;
  return sonar;
}

static void tell(const struct ping* ping) { drive(ping->echo, ping->is_high ^ ping->is_glitched); }

static avr_cycle_count_t errs_no_more(avr_t* chip, avr_cycle_count_t when, void* param) {
  struct ping* ping = param;
  (void)chip, (void)when;
  ping->is_glitched = 0;
  tell(ping);
  return 0;
}

static avr_cycle_count_t errs(avr_t* chip, avr_cycle_count_t when, void* param) {
  struct ping* ping = param;
  (void)when;
  ping->is_glitched = 1;
  tell(ping);
  avr_cycle_timer_register(chip, ping->span, errs_no_more, ping);
  return 0;
}

static avr_cycle_count_t falls(avr_t* chip, avr_cycle_count_t when, void* param) {
  struct ping* ping = param;
  (void)chip, (void)when;
  ping->is_high = 0;
  tell(ping);
  sonar_of(ping->trigger)->is_busy = 0;
  return 0;
}

static avr_cycle_count_t rises(avr_t* chip, avr_cycle_count_t when, void* param) {
  struct ping* ping = param;
  (void)when;
  ping->is_high = 1;
  tell(ping);
  avr_cycle_timer_register(chip, ping->width, falls, ping);
  return 0;
}

/* The trigger: an echo follows where it falls after 10 us or more. */
static void triggered(avr_irq_t* irq, uint32_t level, void* param) {
  struct sonar* const sonar = param;
  (void)irq;
  level &= 1;
  if (level && !sonar->was_high) sonar->rose = avr->cycle;
  if (!level && sonar->was_high && !sonar->is_busy && avr->cycle - sonar->rose >= 160) {
    struct ping* ping = NULL;
    for (struct ping* each = pings; each < pings + ping_count; each++) {
      if (!is_same(each->trigger, sonar->trigger)) continue;
      ping = each;
      if (!each->is_done) break;
    }
    ping->is_done = 1;
    sonar->is_busy = ping->width != 0;
    if (ping->width) avr_cycle_timer_register(avr, ping->delay, rises, ping);
    if (ping->span) avr_cycle_timer_register(avr, ping->at, errs, ping);
  }
  sonar->was_high = level;
}

static void add_ping(struct ping ping) {
  struct sonar* const sonar = sonar_of(ping.trigger);
  if (sonar == sonars + sonar_count) {
    if (sonar_count++ == sizeof sonars / sizeof *sonars) exit(2);
    sonar->trigger = ping.trigger;
    avr_irq_register_notify(pin_of(ping.trigger), triggered, sonar);
  }
  pings[ping_count++] = ping;
}

/* A conversion begins: its channel has the next of its voltages, the last one for good. */
static void converts(avr_irq_t* irq, uint32_t value, void* param) {
  const union {
    avr_adc_mux_t mux;
    uint32_t v;
  } asked = {.v = value};
  struct conversion* found = NULL;
  (void)irq, (void)param;
  for (struct conversion* each = conversions; each < conversions + conversion_count; each++) {
    if (each->channel != asked.mux.src) continue;
    found = each;
    if (!each->is_done) break;
  }
  if (!found) return;
  found->is_done = 1;
  avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_ADC0 + found->channel),
                found->millivolts);
}

static void sends(avr_irq_t* irq, uint32_t value, void* param) {
  (void)irq, (void)param;
  printf("%llu UART %u\n", (unsigned long long)avr->cycle, value & 0xff);
}

static void listen_to_uart(void) {
  uint32_t flags = 0;
  avr_ioctl(avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
  avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_UART_GETIRQ('0'), UART_IRQ_OUTPUT), sends,
                          NULL);
}

static void read_script(void) {
  char line[128], port, second;
  unsigned long long cycle, width, at, span;
  int bit, other, level;
  while (fgets(line, sizeof line, stdin)) {
    if (sscanf(line, "watch %u", &watches[watch_count].address) == 1) {
      watch_count++;
    } else if (sscanf(line, "pin %llu %c %d %d", &cycle, &port, &bit, &level) == 4) {
      changes[change_count++] = (struct change){cycle, {port, bit}, level};
    } else if (sscanf(line, "adc %d %d", &bit, &level) == 2) {
      avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_ADC0 + bit), level);
    } else if (sscanf(line, "next %d %d", &bit, &level) == 2) {
      conversions[conversion_count++] = (struct conversion){bit, level, 0};
    } else if (!strcmp(line, "uart\n")) {
      listen_to_uart();
    } else if (sscanf(line, "ping %c %d %c %d %llu %llu %llu %llu", &port, &bit, &second, &other,
                      &cycle, &width, &at, &span) == 8) {
      add_ping((struct ping){{port, bit}, {second, other}, cycle, width, at, span, 0, 0, 0});
    } else if (sscanf(line, "sweep %u %u %u %c %d", &sweep.step, &sweep.count, &sweep.span,
                      &sweep.wire.port, &sweep.wire.bit) != 5) {
      fprintf(stderr, "not understood: %s", line);
      exit(2);
    }
    if (watch_count == MOST || change_count == MAX_CHANGES || ping_count == MOST ||
        conversion_count == MOST)
      exit(2);
  }
}

static void no_sleep(avr_t* chip, avr_cycle_count_t cycles) { (void)chip, (void)cycles; }

static void note_quiet(void) {
  if (avr->sreg[S_I]) {
    since = avr->cycle;
  } else if (since && avr->cycle - since > quiet) {
    quiet = avr->cycle - since;
  }
}

static void note_changes(void) {
  for (int i = 0; i < watch_count; i++) {
    const unsigned value = avr->data[watches[i].address];
    if (value == watches[i].value) continue;
    watches[i].value = value;
    printf("%llu %u %u\n", (unsigned long long)avr->cycle, watches[i].address, value);
  }
}

static void run_until(unsigned long long end) {
  static int done;
  while (avr->cycle < end) {
    while (done < change_count && changes[done].cycle <= avr->cycle) {
      drive(changes[done].wire, changes[done].level);
      done++;
    }
    const int state = avr_run(avr);
    if (state == cpu_Done || state == cpu_Crashed) break;
    if (is_copy) continue;
    note_quiet();
    note_changes();
  }
}

static void be_copy(unsigned number) {
  is_copy = 1;
  run_until(avr->cycle + (unsigned long long)number * sweep.step);
  drive(sweep.wire, 1);
  run_until(avr->cycle + sweep.span);
  printf("COPY %u", number);
  for (int i = 0; i < watch_count; i++) {
    printf(" %u %u", watches[i].address, avr->data[watches[i].address]);
  }
  printf("\n");
}

int main(int argc, char** argv) {
  elf_firmware_t firmware = {0};
  if (argc != 4 || elf_read_firmware(argv[1], &firmware) || !(avr = avr_make_mcu_by_name(argv[2])))
    return 2;
  const unsigned long long end = strtoull(argv[3], NULL, 10);
  avr_init(avr);
  firmware.frequency = 16000000;
  firmware.vcc = firmware.avcc = firmware.aref = 5000;
  avr_load_firmware(avr, &firmware);
  avr->sleep = no_sleep;
  avr_irq_register_notify(avr_io_getirq(avr, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_OUT_TRIGGER), converts,
                          NULL);
  read_script();
  run_until(end);
  printf("%llu END %llu\n", (unsigned long long)avr->cycle, quiet);
  for (unsigned number = 0; number < sweep.count; number++) {
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
      be_copy(number);
      return 0;
    }
    if (child < 0 || waitpid(child, NULL, 0) < 0) return 2;
  }
  return 0;
}
