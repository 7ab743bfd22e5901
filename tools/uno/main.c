// An Arduino Uno or Mega that is a process: runs a firmware, tells what its pins and its UART do as
// lines of JSON, and does what it is told on the standard input (commands.c). Ends when that is
// closed.
//
//     uno [options] firmware.elf|firmware.hex
//       --board NAME      uno or mega: uno
//       --run SPEED       begin at once; otherwise it waits for the command `run`
//       --baud N          of the pty until somebody sets another, and of the commands: 115200
//       --eeprom FILE     where the EEPROM is kept
//       --reset-on-open   opening the pty resets the board
//       --bootloader HEX  where a reset begins
//       --watch-stack     tell how deep it is on the command `stack`
//       --watch-masked    tell how long interrupts were off on the command `masked`
//       --no-sleep        say nothing of sleeping

#define _GNU_SOURCE
#include <getopt.h>
#include <poll.h>
#include <signal.h>
#include <simavr/sim_elf.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "uno.h"

enum { kSlice = kHertz / 2000 };  // how often the run looks around
enum { kBack = 42 };              // how who comes back from aside ends

avr_t* avr;

static FILE* out;
static bool is_paused = true;
static bool has_ended;
static bool is_aside;
static bool tells_sleep = true;
static Cycle run_until = UINT64_MAX;
static double run_speed;
static double paced_from_s;
static Cycle paced_from;

// -- what it says -------------------------------------------------------------------------------

void tell(Cycle cycle, const char* what, const char* format, ...) {
  va_list values;
  fprintf(out, "{\"cycle\": %llu, \"what\": \"%s\", ", (unsigned long long)cycle, what);
  va_start(values, format);
  vfprintf(out, format, values);
  va_end(values);
  fputs("}\n", out);
}

void give_up(const char* format, ...) {
  va_list values;
  fputs("uno: ", stderr);
  va_start(values, format);
  vfprintf(stderr, format, values);
  va_end(values);
  fputc('\n', stderr);
  exit(2);
}

static void log_error(avr_t* chip, const int level, const char* format, va_list values) {
  (void)chip;
  if (level <= LOG_ERROR) vfprintf(stderr, format, values);
}

// -- the run ------------------------------------------------------------------------------------

static double now_s(void) {
  struct timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return (double)time.tv_sec + (double)time.tv_nsec / 1e9;
}

void interrupt_run(void) { avr->run_cycle_count = 0; }

static void reach(Cycle when, void* what) {
  (void)when;
  (void)what;
  interrupt_run();
}

static void pace(void) {
  paced_from_s = now_s();
  paced_from = avr->cycle;
}

void pause_run(const char* why) {
  is_paused = true;
  cancel(reach, NULL);
  pins_watch(kNoPin, "");
  interrupt_run();
  tell(avr->cycle, "paused", "\"why\": \"%s\"", why);
}

void resume_run(Cycle until, double speed) {
  is_paused = false;
  run_until = until;
  run_speed = speed;
  cancel(reach, NULL);
  if (until != UINT64_MAX) at_cycle(until, reach, NULL);
  pace();
}

void quit_run(void) { has_ended = true; }

void go_aside(void) {
  fflush(out);
  const pid_t aside = fork();
  if (aside < 0) give_up("there is no process to go aside in");
  if (aside == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    is_aside = true;
    pause_run("aside");
    return;
  }
  int status;
  if (waitpid(aside, &status, 0) != aside || !WIFEXITED(status)) _exit(2);
  if (WEXITSTATUS(status) != kBack) _exit(WEXITSTATUS(status));
  pause_run("back");
}

bool come_back(void) {
  if (!is_aside) return false;
  fflush(out);
  _exit(kBack);
}

bool run_is_paused(void) { return is_paused; }

// Waits until commands or bytes come, for at most so many milliseconds; -1: without an end.
static void look(int wait_ms) {
  fflush(out);
  struct pollfd files[] = {{STDIN_FILENO, POLLIN, 0}, {wire_file(), POLLIN, 0}};
  const bool has_pty = !is_paused && !(wait_ms > 0 && poll(&files[1], 1, 0) > 0);
  if (poll(files, has_pty ? 2 : 1, wait_ms) > 0 && files[0].revents && !commands_look()) quit_run();
  if (!is_paused) wire_look();
}

static void look_around(void) {
  int wait_ms = 0;
  if (run_speed > 0) {
    const double ahead_s =
        (double)(avr->cycle - paced_from) / (kHertz * run_speed) - (now_s() - paced_from_s);
    if (ahead_s < -0.05) pace();  // too slow: do not race to catch up
    if (ahead_s > 0.001) wait_ms = (int)(ahead_s * 1000);
  }
  look(wait_ms);
}

// Sleeping without interrupts: only what comes from outside the chip, or the watchdog, ends that.
static void skip_sleep(void) {
  Cycle next = avr->cycle + kSlice;
  if (next_happening() < next) next = next_happening();
  if (next > avr->cycle) avr->cycle = next;
  avr->state = cpu_Sleeping;
}

static void run(void) {
  Cycle look_at = 0;
  bool was_asleep = false;
  while (!has_ended) {
    if (is_paused) {
      look(-1);
      continue;
    }
    if (reset_is_wanted() && reset_where_wanted()) was_asleep = false;
    const int state = avr_run(avr);
    if (stack_is_watched()) stack_look();
    if (masked_is_watched()) masked_look();
    if (state == cpu_Done && !is_paused && !reset_is_wanted()) skip_sleep();
    const bool is_asleep = state == cpu_Sleeping || state == cpu_Done;
    if (is_asleep != was_asleep && tells_sleep) {
      tell(avr->cycle, is_asleep ? "sleep" : "wake", "\"interrupts\": %s",
           avr->sreg[S_I] || !is_asleep ? "true" : "false");
    }
    was_asleep = is_asleep;
    if (state == cpu_Crashed) {
      tell(avr->cycle, "crash", "\"pc\": %d", (int)avr->pc);
      quit_run();
    }
    if (avr->cycle >= run_until && !is_paused) pause_run("cycle");
    if (avr->cycle >= look_at) {
      look_at = avr->cycle + kSlice;
      if (!is_paused) look_around();
    }
  }
}

// -- the board ----------------------------------------------------------------------------------

static void do_nothing(avr_t* chip, avr_cycle_count_t cycles) {
  (void)chip;
  (void)cycles;
}

static bool is_hex(const char* name) {
  const size_t length = strlen(name);
  return length > 4 && strcmp(name + length - 4, ".hex") == 0;
}

static void load_elf(const char* name) {
  elf_firmware_t firmware;
  memset(&firmware, 0, sizeof firmware);
  if (elf_read_firmware(name, &firmware) != 0 || !firmware.flash) give_up("cannot read %s", name);
  if (firmware.flashbase + firmware.flashsize > avr->flashend + 1) give_up("%s is too large", name);
  avr_loadcode(avr, firmware.flash, firmware.flashsize, firmware.flashbase);
}

static void load_hex(const char* name, uint32_t* begin) {
  if (!hex_load(name, avr->flash, avr->flashend + 1, begin)) give_up("cannot read %s", name);
}

static void load(const char* firmware, const char* bootloader) {
  uint32_t begin;
  avr = avr_make_mcu_by_name(board->chip);
  if (!avr || avr_init(avr) != 0) give_up("libsimavr has no %s", board->chip);
  if (is_hex(firmware)) {
    load_hex(firmware, &begin);
  } else {
    load_elf(firmware);
  }
  avr->codeend = avr->flashend;
  avr->frequency = kHertz;
  avr->vcc = avr->avcc = avr->aref = 5000;
  avr->sleep = do_nothing;
  avr->run_cycle_limit = kSlice;
  if (!bootloader) return;
  load_hex(bootloader, &begin);
  avr->reset_pc = begin;
}

int main(int count, char** words) {
  const char *eeprom = NULL, *bootloader = NULL;
  int resets_on_open = false, watches_stack = false, watches_masked = false, is_silent = false;
  int baud = 115200;
  const struct option options[] = {
      {"run", required_argument, NULL, 'r'},
      {"baud", required_argument, NULL, 's'},
      {"eeprom", required_argument, NULL, 'e'},
      {"board", required_argument, NULL, 'b'},
      {"bootloader", required_argument, NULL, 'l'},
      {"reset-on-open", no_argument, &resets_on_open, true},
      {"watch-stack", no_argument, &watches_stack, true},
      {"watch-masked", no_argument, &watches_masked, true},
      {"no-sleep", no_argument, &is_silent, true},
      {0},
  };
  const char* firmware = NULL;
  for (int found; (found = getopt_long(count, words, "-", options, NULL)) != -1;) {
    if (found == 1 && firmware) give_up("what is %s?", optarg);
    if (found == 1) firmware = optarg;
    if (found == 'r') {
      is_paused = false;
      run_speed = atof(optarg);
    }
    if (found == 's') baud = atoi(optarg);
    if (found == 'e') eeprom = optarg;
    if (found == 'b' && !board_choose(optarg)) give_up("there is no board %s", optarg);
    if (found == 'l') bootloader = optarg;
    if (found == '?') exit(2);
  }
  tells_sleep = !is_silent;
  if (!firmware) give_up("which firmware?");
  if (baud <= 0) give_up("which baud?");
  // What libsimavr prints is no JSON.
  out = fdopen(dup(STDOUT_FILENO), "w");
  if (!out || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) give_up("there is no standard output");
  avr_global_logger_set(log_error);
  load(firmware, bootloader);
  chip_begin();
  pins_begin();
  uart_begin();
  eeprom_begin(eeprom);
  wire_begin(resets_on_open, baud);
  if (watches_stack) stack_begin();
  if (watches_masked) masked_begin();
  reset_soon(kPowerOn);
  reset_where_wanted();
  pace();
  fflush(out);
  run();
  tell(avr->cycle, "end", "\"state\": %d", avr->state);
  fflush(out);
  return avr->state == cpu_Crashed ? 3 : 0;
}
