// The functions that the firmware needs of the board besides `robot.h` and `nvm.h`.
//
// Plain functions: each build links one definition of them (a board, a test, a simulation). None of
// them blocks.

#pragma once

#include <stdint.h>

#include "../link/port.h"

namespace tiniscript {

// The cause of the last reset, and a seed that rarely repeats.
struct BootInfo {
  Reset reset;
  uint32_t seed;
};

// The board's kit; on an AVR the compiler knows all of these. `board_readings` are the last
// readings, of a remote control, too, `board_max_run_ms` is the longest run without a dead-man timer.
uint16_t board_kit();
uint8_t board_sensors();
uint8_t board_actuators();
int32_t* board_readings();
uint32_t board_max_run_ms();

// The speed, or turning speed, of the kit at 100 %: thousandths in a second; 0: unknown.
uint32_t board_speed(bool is_turn);

// A place in a program: the checksum of the image and the offset of an instruction.
struct Place {
  uint32_t checksum;
  uint16_t offset;
};

// Sets the outputs of the motor driver, -255 to 255; positive is forward. Has no effect while the
// latch is closed.
void board_motors(int16_t left, int16_t right);

// The same, many times in a move that is measured.
void board_steer(int16_t left, int16_t right);

// Closes the latch: motors are off until `board_release`.
void board_stop();
void board_release();

// Turns off the actuators that a stop turns off: yes/no actuators FALSE, servos without pulses.
// Call it while the latch is closed, so that no program sets them meanwhile.
void board_actuators_off();

// Whether the main loop has hung since the last call; the board has then turned the motors off.
bool board_take_stall();

// The slotted discs on both wheels.
struct Discs {
  uint32_t cm;       // that a wheel goes between two edges of its disc, in 64ths of thousandths; 0:
                     // it has no discs
  uint32_t degrees;  // that the robot turns on the spot then
  bool has_two;      // channels: it counts back while the wheel turns backward
};

// Only a machine with `tiniscript_has_discs` calls it. Edges are counted since the start, modulo
// 2^16.
Discs board_discs();
uint16_t board_edges(bool is_right);

LineErrors board_line_errors();

// Whether the watchdog caused this reset, and what ran then: zeros if nothing did. Reported once.
bool board_take_hang(Place* place);

// A program begins: discards readings that were not fetched.
void board_forget();

// Whether the voltage is high enough to write data that must not be corrupted. Starts a measurement
// if none is under way, and reports each result once. Call it in every tick until then: a
// measurement without a request is dropped.
enum class Supply : uint8_t { kMeasuring, kLow, kEnough };
Supply board_supply();

// The light is on while a press of the button would start a program.
void board_light(bool is_on);

// The robot's WiFi, or its broker, as the step asks. Setting it may stop the chip for a while: not
// while motors are on.
WifiReport board_wifi(WifiStep step);
Answer board_set_wifi(WifiStep step, const uint8_t* text, uint8_t length);

// The sound for the end of a program, and the one for a fault.
void board_finished();
void board_faulted();

}  // namespace tiniscript
