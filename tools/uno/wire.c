// The other end of the two wires of UART 0: what the commands send, and a pty for programs that
// open serial ports. Bits take the time that the sender gives them, so a wrong baud is garbage.

#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <pty.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "uno.h"

enum { kRing = 1 << 16, kPatience = 16 };

// -- to the chip --------------------------------------------------------------------------------

// Levels of the wire, one for each bit and the first one lowest; or one level for many bits.
struct Item {
  Cycle not_before;
  double bit_cycles;
  uint32_t levels;
  uint32_t count;
  bool is_held;
};

static struct Item ring[kRing];
static unsigned ring_begin;
static unsigned ring_end;
static bool is_busy;
static bool level = true;
static double item_began;
static uint32_t item_bit;
static double own_bit_cycles;

static void next_bit(Cycle when, void* what);

static void begin_item(Cycle earliest) {
  is_busy = ring_begin != ring_end;
  if (!is_busy) return;
  const struct Item* item = &ring[ring_begin % kRing];
  item_began = (double)(item->not_before > earliest ? item->not_before : earliest);
  item_bit = 0;
  at_cycle((Cycle)item_began, next_bit, NULL);
}

static void next_bit(Cycle when, void* what) {
  (void)what;
  const struct Item* item = &ring[ring_begin % kRing];
  if (item_bit == item->count) {
    ring_begin++;
    begin_item(when);
    return;
  }
  const bool now = item->is_held ? item->levels & 1 : item->levels >> item_bit & 1;
  if (now != level) {
    level = now;
    pin_wire(level);
    uart_wire(when, level);
  }
  item_bit = item->is_held ? item->count : item_bit + 1;
  at_cycle((Cycle)(item_began + item_bit * item->bit_cycles + 0.5), next_bit, NULL);
}

static void push(struct Item item) {
  if (ring_end - ring_begin == kRing) give_up("more than %d bytes wait for the wire", kRing);
  ring[ring_end++ % kRing] = item;
  if (!is_busy) begin_item(0);
}

static void push_byte(Cycle when, uint8_t byte, bool stop, double bit_cycles) {
  const uint32_t levels = (uint32_t)byte << 1 | (uint32_t)stop << 9 | 1 << 10;
  push((struct Item){when, bit_cycles, levels, stop ? 10 : 11, false});
}

void wire_send(Cycle when, uint8_t byte, bool stop) { push_byte(when, byte, stop, own_bit_cycles); }

void wire_hold(Cycle when, bool held, uint32_t bits) {
  push((struct Item){when, own_bit_cycles, held, bits, true});
  push((struct Item){when, own_bit_cycles, 1, 1, true});
}

// -- the pty ------------------------------------------------------------------------------------

static int master = -1;
static bool is_open;
static bool is_reset_by_opening;

static const struct {
  speed_t code;
  int speed;
} speeds[] = {{B1200, 1200},     {B2400, 2400},     {B4800, 4800},     {B9600, 9600},
              {B19200, 19200},   {B38400, 38400},   {B57600, 57600},   {B115200, 115200},
              {B230400, 230400}, {B460800, 460800}, {B500000, 500000}, {B1000000, 1000000}};
enum { kSpeeds = sizeof speeds / sizeof *speeds };

static speed_t code_of(int speed) {
  for (int k = 0; k < kSpeeds; k++) {
    if (speeds[k].speed == speed) return speeds[k].code;
  }
  give_up("a pty has no %d baud", speed);
}

// Returns how long a bit takes whoever has opened the pty.
static double pty_bit_cycles(void) {
  struct termios settings;
  if (tcgetattr(master, &settings) == 0) {
    for (int k = 0; k < kSpeeds; k++) {
      if (cfgetospeed(&settings) == speeds[k].code) return (double)kHertz / speeds[k].speed;
    }
  }
  return own_bit_cycles;
}

// One byte as somebody reads it whose bits have another length; its neighbours are not looked at.
static uint8_t read_with(uint8_t byte, double sent, double read) {
  const uint32_t levels = (uint32_t)byte << 1 | ~(uint32_t)0 << 9;
  uint8_t seen = 0;
  for (int bit = 1; bit <= 8; bit++) {
    const int at = (int)((bit + 0.5) * read / sent);
    if (at > 9 || levels >> at & 1) seen |= (uint8_t)(1 << (bit - 1));
  }
  return seen;
}

void wire_receive(Cycle when, uint8_t byte, double bit_cycles) {
  if (master < 0 || !is_open) return;  // nobody keeps it
  const uint8_t seen = read_with(byte, bit_cycles, pty_bit_cycles());
  if (write(master, &seen, 1) != 1) tell(when, "port", "\"does\": \"lost\", \"byte\": %d", seen);
}

void wire_look(void) {
  if (master < 0 || ring_end - ring_begin > kPatience) return;
  uint8_t bytes[kPatience];
  const ssize_t got = read(master, bytes, sizeof bytes);
  const bool was_open = is_open;
  is_open = !(got < 0 && errno == EIO);
  if (is_open != was_open) {
    tell(avr->cycle, "port", "\"does\": \"%s\"", is_open ? "opened" : "closed");
    if (is_open && is_reset_by_opening) reset_soon(kExternal);
  }
  if (got <= 0) return;
  const double bit_cycles = pty_bit_cycles();
  for (ssize_t k = 0; k < got; k++) push_byte(avr->cycle, bytes[k], true, bit_cycles);
}

int wire_file(void) { return master; }

void wire_begin(bool resets_on_open, int speed) {
  is_reset_by_opening = resets_on_open;
  struct termios settings;
  memset(&settings, 0, sizeof settings);
  cfmakeraw(&settings);
  settings.c_cflag |= CREAD | CS8 | CLOCAL;
  cfsetspeed(&settings, code_of(speed));
  own_bit_cycles = (double)kHertz / speed;
  int slave;
  char name[128];
  if (openpty(&master, &slave, name, &settings, NULL) != 0) give_up("there is no pty");
  close(slave);
  fcntl(master, F_SETFL, O_NONBLOCK);
  pin_wire(level);
  tell(0, "pty", "\"name\": \"%s\"", name);
}
