// What one may tell the simulated Uno, a line each:
//
//     run CYCLE|forever SPEED   goes on; SPEED 1 is real time, 0 as fast as it goes
//     watch PIN STATE           the next run pauses when a pin is low, high, pwm, input or pullup
//     pause, quit
//     aside, back               while it is paused; what is told between has not happened then
//     pin PIN low|high|none     what is wired to it gives it a level, or leaves it alone
//     analog PIN COUNT          0 to 1023, as the chip will read it
//     supply MILLIVOLTS         of the chip, as its converter sees it
//     sonar TRIGGER ECHO MM     an HC-SR04 and what is before it; 0: nothing
//     send HEX, send_bad HEX    bytes one after the other; bad: with a stop bit that is low
//     hold low|high BITS        a break, or silence
//     reset external|power-on|brown-out
//     stack ADDRESS             tell how deep it went, and what nobody has written from there on
//     masked                    tell how long interrupts were off
//
// `at CYCLE` before a line lets it happen then, `after CYCLES` so much later than now. Without them
// it happens at once.

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "uno.h"

enum { kLine = 70000, kWord = 32 };

static bool is_word(const char* one, const char* other) { return strcmp(one, other) == 0; }

static bool send_hex(Cycle when, const char* hex, bool stop) {
  unsigned byte;
  for (; sscanf(hex, "%2x", &byte) == 1; hex += 2) {
    wire_send(when, (uint8_t)byte, stop);
    if (!hex[1]) return false;
  }
  return *hex == 0;
}

// Does what concerns the run itself; false where it is another command.
static bool steer(const char* line) {
  char first[kWord], second[kWord];
  double speed;
  if (sscanf(line, "run %31s %lf", first, &speed) == 2) {
    resume_run(is_word(first, "forever") ? UINT64_MAX : strtoull(first, NULL, 10), speed);
  } else if (sscanf(line, "watch %31s %31s", first, second) == 2) {
    pins_watch(pin_number(first), second);
  } else if (is_word(line, "pause")) {
    pause_run("command");
  } else if (is_word(line, "quit")) {
    quit_run();
  } else if (is_word(line, "aside") && run_is_paused()) {
    go_aside();
  } else if (is_word(line, "back")) {
    return come_back();
  } else {
    return false;
  }
  return true;
}

static bool drive(int pin, const char* level) {
  if (pin == kNoPin) return false;
  if (is_word(level, "none")) {
    pin_drive(pin, kReleased);
  } else if (is_word(level, "low") || is_word(level, "high")) {
    pin_drive(pin, is_word(level, "high") ? kHigh : kLow);
  } else {
    return false;
  }
  return true;
}

static bool reset_for(const char* cause) {
  if (is_word(cause, "external")) {
    reset_soon(kExternal);
  } else if (is_word(cause, "power-on")) {
    reset_soon(kPowerOn);
  } else if (is_word(cause, "brown-out")) {
    reset_soon(kBrownOut);
  } else {
    return false;
  }
  return true;
}

static bool is_done(Cycle when, const char* line) {
  char first[kWord], second[kWord];
  int number;
  if (sscanf(line, "pin %31s %31s", first, second) == 2) return drive(pin_number(first), second);
  if (sscanf(line, "reset %31s", first) == 1) return reset_for(first);
  if (sscanf(line, "sonar %31s %31s %d", first, second, &number) == 3) {
    const int trigger = pin_number(first);
    const int echo = pin_number(second);
    return trigger != kNoPin && echo != kNoPin && sonar_set(trigger, echo, number);
  }
  if (sscanf(line, "analog %31s %d", first, &number) == 2 && first[0] == 'A') {
    analog_set(atoi(first + 1), number);
    return true;
  }
  if (sscanf(line, "supply %d", &number) == 1 && number >= 2000 && number <= 6000) {
    supply_set(number);
    return true;
  }
  if (sscanf(line, "stack %d", &number) == 1 && number >= 0 && number <= avr->ramend) {
    stack_tell(number);
    return true;
  }
  if (is_word(line, "masked")) {
    masked_tell();
    return true;
  }
  if (strncmp(line, "send ", 5) == 0) return send_hex(when, line + 5, true);
  if (strncmp(line, "send_bad ", 9) == 0) return send_hex(when, line + 9, false);
  if (sscanf(line, "hold %31s %d", first, &number) == 2 && number > 0) {
    wire_hold(when, is_word(first, "high"), (uint32_t)number);
    return true;
  }
  return false;
}

static void do_now(Cycle when, const char* line) {
  if (steer(line) || is_done(when, line)) return;
  char shown[kWord];
  size_t length = 0;
  for (; line[length] && length + 1 < sizeof shown; length++) {
    const char letter = line[length];
    shown[length] = letter >= ' ' && letter <= '~' && !strchr("\"\\", letter) ? letter : '?';
  }
  shown[length] = 0;
  tell(avr->cycle, "mistake", "\"text\": \"this is no command: %s\"", shown);
}

static void do_later(Cycle when, void* what) {
  do_now(when, what);
  free(what);
}

static void command(const char* line) {
  unsigned long long when;
  int rest = 0;
  const bool is_later = sscanf(line, "after %llu %n", &when, &rest) == 1 && rest > 0;
  if (is_later || (sscanf(line, "at %llu %n", &when, &rest) == 1 && rest > 0)) {
    if (is_later) when += avr->cycle;
    char* kept = strdup(line + rest);
    if (!kept) give_up("no memory");
    at_cycle(when, do_later, kept);
  } else {
    do_now(avr->cycle, line);
  }
}

bool commands_look(void) {
  static char lines[kLine];
  static size_t used;
  const ssize_t got = read(STDIN_FILENO, lines + used, sizeof lines - 1 - used);
  if (got <= 0) return false;
  used += (size_t)got;
  lines[used] = 0;
  char* begin = lines;
  for (char* end; (end = strchr(begin, '\n')); begin = end + 1) {
    *end = 0;
    command(begin);
  }
  used = strlen(begin);
  memmove(lines, begin, used + 1);
  if (used == sizeof lines - 1) give_up("a command is longer than %d letters", kLine);
  return true;
}
