// An Arduino Uno or Mega that is a process: what its parts may ask of each other.
//
// libsimavr runs the instructions, timers, ADC and pins. The UART, the EEPROM, the watchdog and the
// causes of a reset are here, because libsimavr 1.6 gives them other times than silicon.

#pragma once

#include <simavr/sim_avr.h>
#include <stdbool.h>
#include <stdint.h>

enum { kHertz = 16000000, kMaxPins = 70, kNoPin = -1 };

typedef uint64_t Cycle;

extern avr_t* avr;

// -- main.c: the run ----------------------------------------------------------------------------

// Says a line of JSON: the cycle, what it is, and the rest, as printf does.
void tell(Cycle cycle, const char* what, const char* format, ...)
    __attribute__((format(printf, 3, 4)));

// Ends the run in a way that tells why; for what cannot go on.
void give_up(const char* format, ...) __attribute__((format(printf, 1, 2), noreturn));

// Lets the chip stop after the instruction that it is at, so that the run can look around.
void interrupt_run(void);

void pause_run(const char* why);
void resume_run(Cycle until, double speed);
void quit_run(void);
bool run_is_paused(void);

// Goes on in a copy of this process, while this one waits; `come_back` ends the copy, and all that it
// did has not happened. False: nobody has gone aside. What a file of the EEPROM has, it keeps.
void go_aside(void);
bool come_back(void);

// -- boards.c: the Uno and the Mega --------------------------------------------------------------

// An output of a timer: its pin, and its channel, 0 for A.
struct Output {
  int pin, timer, channel;
};

struct Board {
  const char* name;
  const char* chip;
  uint16_t eeprom_bytes;
  struct {
    uint8_t watchdog, received, empty, sent, eeprom;
  } vectors;
  int digital_pins;
  int analog_pins;
  int timers;
  uint8_t external_interrupts;
  const char* places;  // of each pin: the letter of its port, and its bit
  const struct Output* outputs;
  unsigned output_count;
};

extern const struct Board* board;

// False: there is no such board.
bool board_choose(const char* name);

// -- queue.c: what happens at a cycle -----------------------------------------------------------

typedef void (*Happening)(Cycle when, void* what);

void at_cycle(Cycle when, Happening happening, void* what);
void cancel(Happening happening, void* what);

// Where nothing is to happen: the end of time.
Cycle next_happening(void);

// A reset forgets the timers of libsimavr, and the one of the queue is among them.
void queue_after_reset(void);

// -- chip.c: resets, watchdog, interrupts that stay raised --------------------------------------

enum Cause { kPowerOn = 1, kExternal = 2, kBrownOut = 4, kWatchdog = 8 };  // bits of MCUSR

void chip_begin(void);

// Resets the chip after the instruction that it is at.
void reset_soon(enum Cause cause);
bool reset_is_wanted(void);
bool reset_where_wanted(void);

// Calls `write` or `read` for a register instead of what libsimavr has for it.
void take_register(uint16_t address, avr_io_read_t read, avr_io_write_t write);

// Calls `notify` where an interrupt is entered and left, with its vector.
void on_interrupts(avr_irq_notify_t notify);

// An interrupt that is asked for as long as `wants` says so. `entered` may be none.
struct Asking {
  bool (*wants)(void);
  void (*entered)(void);
  avr_int_vector_t* vector;
};

void asking_begin(struct Asking* asking, uint8_t vector);
void asking_refresh(struct Asking* asking);

// -- uart.c: UART 0 as the chip sees it ---------------------------------------------------------

void uart_begin(void);
void uart_after_reset(void);

// The level of the wire to the chip has changed.
void uart_wire(Cycle when, bool level);

// -- wire.c: the other end of the two wires -----------------------------------------------------

// What the commands send has so many bits in a second; the pty has those of its settings.
void wire_begin(bool resets_on_open, int speed);

// Sends a byte after all that is waiting, from `when` on. With `stop` false its stop bit is low.
void wire_send(Cycle when, uint8_t byte, bool stop);

// Holds the wire low, or leaves it alone, for so many bits.
void wire_hold(Cycle when, bool level, uint32_t bits);

// The chip has sent a byte, with bits of this length.
void wire_receive(Cycle when, uint8_t byte, double bit_cycles);

// Asks the pty for news, and returns its file.
void wire_look(void);
int wire_file(void);

// -- pins.c -------------------------------------------------------------------------------------

void pins_begin(void);
void pins_after_reset(void);
int pin_number(const char* name);

// What is wired to a pin gives it a level; kReleased leaves it alone.
enum Drive { kReleased = -1, kLow = 0, kHigh = 1 };
void pin_drive(int pin, enum Drive drive);

// The same for the pin that the UART receives with, untold: `received` tells it better.
enum { kReceivePin = 0 };
void pin_wire(bool level);

// Pauses the run when a pin gets into a state: "high", "low", "pwm", "input" or "pullup".
void pins_watch(int pin, const char* state);

void analog_set(int channel, int count);

// The voltage of the chip's supply; 5 V at first. The converter alone knows of it.
void supply_set(int millivolts);

// -- sonar.c ------------------------------------------------------------------------------------

// Puts an HC-SR04 at two pins, or moves what is in front of it. 0 mm: there is nothing.
bool sonar_set(int trigger, int echo, int distance_mm);
void sonar_trigger(Cycle when, int pin, bool level);

// -- eeprom.c -----------------------------------------------------------------------------------

void eeprom_begin(const char* file);
void eeprom_after_reset(bool is_power_on);

// -- hex.c --------------------------------------------------------------------------------------

// Puts what an Intel HEX file holds into a flash with room for so many bytes, and says where it
// begins. False: it is no such file, damaged, or larger than that.
bool hex_load(const char* name, uint8_t* flash, uint32_t room, uint32_t* begin);

// -- stack.c ------------------------------------------------------------------------------------

// Watches the stack from now on, which takes its time.
void stack_begin(void);
bool stack_is_watched(void);
void stack_look(void);
void stack_after_reset(bool is_power_on);

// Tells how many bytes from an address on are as power-on has left them, and how deep it went.
void stack_tell(int from);

// -- masked.c -----------------------------------------------------------------------------------

// Watches from now on how long interrupts are off, which takes its time.
void masked_begin(void);
bool masked_is_watched(void);
void masked_look(void);
void masked_after_reset(void);

// Tells the longest time of each place, and then how many there are.
void masked_tell(void);

// -- commands.c ---------------------------------------------------------------------------------

// Does what is waiting on the standard input. False: it has been closed.
bool commands_look(void);
