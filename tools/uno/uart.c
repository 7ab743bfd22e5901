// UART 0 as the chip sees it: bits that take their time, a buffer of two bytes behind a shift
// register, overrun and framing errors. Eight data bits, no parity.

#include <stddef.h>

#include "uno.h"

enum {
  kUcsra = 0xc0,
  kUcsrb = 0xc1,
  kUcsrc = 0xc2,
  kUbrrl = 0xc4,
  kUbrrh = 0xc5,
  kUdr = 0xc6,
  kReceived = 0x80,
  kSent = 0x40,
  kEmpty = 0x20,
  kFrameError = 0x10,
  kOverrun = 0x08,
  kDouble = 0x02,
  kMultiple = 0x01,
  kReceives = 0x10,
  kSends = 0x08,
  kAsksReceived = 0x80,
  kAsksSent = 0x40,
  kAsksEmpty = 0x20,
  kDataBits = 8,
};

static uint8_t double_speed;  // the bits of UCSR0A that a program writes
static uint8_t enabled;       // UCSR0B

static double bit_cycles(void) {
  const int divisor = (avr->data[kUbrrl] | (avr->data[kUbrrh] & 15) << 8) + 1;
  return divisor * (double_speed & kDouble ? 8.0 : 16.0);
}

// -- from the wire ------------------------------------------------------------------------------

struct Received {
  uint8_t byte;
  uint8_t errors;
};

static struct Received buffer[2];
static int held;
static struct Received shifted;  // a third byte, while the buffer is full
static bool is_waiting;
static bool has_lost;
static bool wire_level = true;
static int bit_number = -1;
static uint8_t bits;
static double begun;
static double period;
static struct Asking asking_received;

static bool received_wants(void) { return held > 0 && (enabled & kAsksReceived); }

static void move_up(void) {
  if (!is_waiting || held == 2) return;
  if (has_lost) shifted.errors |= kOverrun;
  has_lost = false;
  is_waiting = false;
  buffer[held++] = shifted;
}

static void sample(Cycle when, void* what);

static void sample_next(void) {
  // The middle of a bit is the last of three samples, of which two decide.
  at_cycle((Cycle)(begun + period * (bit_number + 0.5625)), sample, NULL);
}

static void sample(Cycle when, void* what) {
  (void)what;
  if (bit_number == 0 && wire_level) {
    bit_number = -1;  // no start bit: a spike
  } else if (bit_number <= kDataBits) {
    if (bit_number > 0) bits = (uint8_t)(bits >> 1 | wire_level << 7);
    bit_number++;
    sample_next();
  } else {
    bit_number = -1;
    shifted = (struct Received){bits, wire_level ? 0 : kFrameError};
    is_waiting = true;
    tell(when, "received", "\"byte\": %d, \"began\": %llu%s", bits, (unsigned long long)begun,
         wire_level ? "" : ", \"framing_error\": true");
    move_up();
    asking_refresh(&asking_received);
  }
}

static void begin_byte(Cycle when) {
  if (bit_number >= 0 || !(enabled & kReceives)) return;
  if (is_waiting) {
    tell(when, "lost", "\"byte\": %d", shifted.byte);
    is_waiting = false;
    has_lost = true;
  }
  bit_number = 0;
  begun = (double)when;
  period = bit_cycles();
  sample_next();
}

void uart_wire(Cycle when, bool level) {
  const bool falls = wire_level && !level;
  wire_level = level;
  if (falls) begin_byte(when);
}

static void receiver_off(void) {
  cancel(sample, NULL);
  bit_number = -1;
  held = 0;
  is_waiting = has_lost = false;
}

static uint8_t data_read(avr_t* chip, avr_io_addr_t address, void* param) {
  (void)param;
  uint8_t byte = chip->data[address];
  if (held > 0) {
    byte = buffer[0].byte;
    buffer[0] = buffer[1];
    held--;
    move_up();
  }
  asking_refresh(&asking_received);
  return chip->data[address] = byte;
}

// -- to the wire --------------------------------------------------------------------------------

static bool is_sending;
static uint8_t sending;
static bool is_next;
static uint8_t next_byte;
static bool is_sent;
static Cycle send_began;
static double send_bit;
static struct Asking asking_empty;
static struct Asking asking_sent;

static bool empty_wants(void) { return !is_next && (enabled & kAsksEmpty) && (enabled & kSends); }
static bool sent_wants(void) { return is_sent && (enabled & kAsksSent); }
static void sent_entered(void) { is_sent = false; }

static void send(Cycle now, uint8_t byte);

static void sent(Cycle when, void* what) {
  (void)what;
  is_sending = false;
  tell(when, "sent", "\"byte\": %d, \"began\": %llu", sending, (unsigned long long)send_began);
  wire_receive(when, sending, send_bit);
  if (is_next) {
    is_next = false;
    send(when, next_byte);
    asking_refresh(&asking_empty);
  } else {
    is_sent = true;
    asking_refresh(&asking_sent);
  }
}

static void send(Cycle now, uint8_t byte) {
  is_sending = true;
  sending = byte;
  send_began = now;
  send_bit = bit_cycles();
  at_cycle(now + (Cycle)(send_bit * (kDataBits + 2)), sent, NULL);
}

static void data_write(avr_t* chip, avr_io_addr_t address, uint8_t value, void* param) {
  (void)address;  // what is read there is another register
  (void)param;
  if (!(enabled & kSends)) return;
  if (!is_sending) {
    send(chip->cycle, value);
  } else if (!is_next) {
    is_next = true;
    next_byte = value;
  }
  asking_refresh(&asking_empty);
}

// -- its registers ------------------------------------------------------------------------------

static uint8_t status_read(avr_t* chip, avr_io_addr_t address, void* param) {
  (void)param;
  uint8_t status = double_speed;
  if (held > 0) status |= (uint8_t)(kReceived | buffer[0].errors);
  if (!is_next) status |= kEmpty;
  if (is_sent) status |= kSent;
  return chip->data[address] = status;
}

static void status_write(avr_t* chip, avr_io_addr_t address, uint8_t value, void* param) {
  (void)param;
  double_speed = value & (kDouble | kMultiple);
  if (value & kSent) is_sent = false;
  asking_refresh(&asking_sent);
  status_read(chip, address, NULL);
}

static void enable_write(avr_t* chip, avr_io_addr_t address, uint8_t value, void* param) {
  (void)param;
  const bool begins = !(enabled & kReceives) && (value & kReceives);
  enabled = value;
  chip->data[address] = value;
  if (begins && !wire_level) begin_byte(chip->cycle);
  if (!(value & kReceives)) receiver_off();
  asking_refresh(&asking_received);
  asking_refresh(&asking_empty);
  asking_refresh(&asking_sent);
}

void uart_after_reset(void) {
  receiver_off();
  cancel(sent, NULL);
  is_sending = is_next = is_sent = false;
  double_speed = enabled = 0;
  avr->data[kUcsra] = kEmpty;
  avr->data[kUcsrb] = 0;
  avr->data[kUcsrc] = 0x06;
}

void uart_begin(void) {
  asking_received = (struct Asking){received_wants, NULL, NULL};
  asking_empty = (struct Asking){empty_wants, NULL, NULL};
  asking_sent = (struct Asking){sent_wants, sent_entered, NULL};
  asking_begin(&asking_received, board->vectors.received);
  asking_begin(&asking_empty, board->vectors.empty);
  asking_begin(&asking_sent, board->vectors.sent);
  take_register(kUdr, data_read, data_write);
  take_register(kUcsra, status_read, status_write);
  take_register(kUcsrb, NULL, enable_write);
  take_register(kUcsrc, NULL, NULL);
  take_register(kUbrrl, NULL, NULL);
  take_register(kUbrrh, NULL, NULL);
}
