// The EEPROM: 3.4 ms for a byte, of which the first half erases it. Its file has each byte as soon
// as the chip has it, so that a power cut leaves there what it leaves on a chip.

#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include "uno.h"

enum {
  kMaxBytes = 4096,
  kEecr = 0x3f,
  kEedr = 0x40,
  kEearl = 0x41,
  kEearh = 0x42,
  kRead = 1,
  kWrite = 2,
  kMayWrite = 4,
  kAsks = 8,
  kMode = 0x30,
  kEraseOnly = 0x10,
  kWriteOnly = 0x20,
  kMayWriteCycles = 4,
  kHalfCycles = kHertz / 10000 * 18,   // 1.8 ms: one of the two halves alone
  kWholeCycles = kHertz / 10000 * 34,  // 3.4 ms
};

static uint8_t bytes[kMaxBytes];
static int file = -1;
static uint8_t control;
static Cycle may_write_until;
static bool is_busy;
static uint16_t place;
static uint8_t value;
static struct Asking ready;

static void put(Cycle when, uint8_t byte) {
  bytes[place] = byte;
  if (file >= 0 && pwrite(file, &byte, 1, place) != 1) give_up("cannot write the EEPROM's file");
  tell(when, "eeprom", "\"address\": %d, \"value\": %d", place, byte);
}

static void programmed(Cycle when, void* what) {
  (void)what;
  put(when, bytes[place] & value);  // programming only clears bits
}

static void finished(Cycle when, void* what) {
  (void)when;
  (void)what;
  is_busy = false;
  asking_refresh(&ready);
}

static void begin_write(Cycle now) {
  const uint8_t mode = control & kMode;
  place = (uint16_t)((avr->data[kEearl] | avr->data[kEearh] << 8) & (board->eeprom_bytes - 1));
  value = avr->data[kEedr];
  is_busy = true;
  asking_refresh(&ready);
  const Cycle end = now + (mode ? kHalfCycles : kWholeCycles);
  if (mode != kWriteOnly) put(now, 0xff);
  if (mode != kEraseOnly) at_cycle(mode ? end : now + kHalfCycles, programmed, NULL);
  at_cycle(end, finished, NULL);
  avr->cycle += 2;  // the chip stands still for so long
}

static uint8_t control_read(avr_t* chip, avr_io_addr_t address, void* param) {
  (void)param;
  uint8_t bits = control & (kMode | kAsks);
  if (is_busy) bits |= kWrite;
  if (chip->cycle < may_write_until) bits |= kMayWrite;
  return chip->data[address] = bits;
}

static void control_write(avr_t* chip, avr_io_addr_t address, uint8_t bits, void* param) {
  (void)param;
  const bool may_write = chip->cycle < may_write_until;
  if (!is_busy) control = bits & kMode;
  control = (uint8_t)((control & kMode) | (bits & kAsks));
  chip->data[address] = control;
  if ((bits & kWrite) && may_write && !is_busy) {
    may_write_until = 0;
    begin_write(chip->cycle);
  } else if ((bits & kMayWrite) && !may_write) {
    may_write_until = chip->cycle + kMayWriteCycles + 1;
  }
  if ((bits & kRead) && !is_busy) {
    const int from = (chip->data[kEearl] | chip->data[kEearh] << 8) & (board->eeprom_bytes - 1);
    chip->data[kEedr] = bytes[from];
    chip->cycle += 4;
  }
  asking_refresh(&ready);
}

static bool ready_wants(void) { return (control & kAsks) && !is_busy; }

// A reset of another kind than power-on lets a write end.
void eeprom_after_reset(bool is_power_on) {
  control = 0;
  may_write_until = 0;
  if (!is_power_on) return;
  is_busy = false;
  cancel(programmed, NULL);
  cancel(finished, NULL);
}

void eeprom_begin(const char* name) {
  memset(bytes, 0xff, sizeof bytes);
  ready = (struct Asking){ready_wants, NULL, NULL};
  asking_begin(&ready, board->vectors.eeprom);
  take_register(kEecr, control_read, control_write);
  if (!name) return;
  file = open(name, O_RDWR | O_CREAT, 0600);
  if (file < 0) give_up("cannot open %s", name);
  const ssize_t length = pread(file, bytes, board->eeprom_bytes, 0);
  if (length < 0 || pwrite(file, bytes, board->eeprom_bytes, 0) != board->eeprom_bytes) {
    give_up("cannot read and write %s", name);
  }
}
