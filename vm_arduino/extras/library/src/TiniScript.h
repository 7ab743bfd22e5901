// The machine of TiniScript for a sketch of your own: it runs images that `tsc compile` has made.
//
// A robot says what its motors and sensors do, a kit names its devices, a player loads an image and
// runs it a little in each turn of loop(). Nothing here waits, and nothing knows a pin.

#pragma once

#include "robot.h"
#include "vm/image.h"
#include "vm/machine.h"

// What programs do to a robot, and what they ask of it. Whatever is left out does nothing, and
// reads 0. No function may wait. Numbers are thousandths; TRUE is 1.
class TiniRobot {
 public:
  // Sets both motors, -100 to 100 percent.
  virtual void motors(int8_t left, int8_t right) {
    (void)left;
    (void)right;
  }

  // Puts a reading into `*value`. False: it is not there yet; the program waits and asks again.
  virtual bool read(uint8_t sensor, int32_t* value) {
    (void)sensor;
    *value = 0;
    return true;
  }

  // Starts a sound of 31 to 20000 hertz, which ends by itself.
  virtual void beep(uint16_t hertz, uint32_t duration_ms) {
    (void)hertz;
    (void)duration_ms;
  }

  // Takes a value that a program shows. False: there is no room; the program waits and tries again.
  virtual bool show(int32_t value, bool is_yes_no) {
    (void)value;
    (void)is_yes_no;
    return true;
  }

  // Sets an actuator: rounds a number to whole ones and limits it to the actuator's range.
  virtual void set(uint8_t actuator, int32_t value) {
    (void)actuator;
    (void)value;
  }

  // How fast it goes, or turns, at 100 %: thousandths of a centimetre or a degree in a second, as
  // the profile's `speed` and `turn` say. 0: not known, and F(20 CM, 60) is the fault NO_POWER.
  virtual uint32_t speed(bool is_turn) const {
    (void)is_turn;
    return 0;
  }
};

// The devices of a robot: one line for each, as `bytecode_spec.md` hashes it, first the sensors,
// then the actuators, at most 32 of each: "sensor DISTANCE number cm 0 400000". The profile that
// `tsc compile --robot` gets has the same devices in the same order.
struct TiniKit {
  const char* const* lines;
  uint8_t sensors;
  uint8_t actuators;

  uint16_t hash(uint16_t device) const;
  uint16_t fingerprint() const;
};

// Loads images and runs one. There is one player in a sketch: it is what the machine asks.
class TiniPlayer {
 public:
  // `memory` has `bytes` for an image, up to 4 of them for what lies after it; `readings` has a
  // place for each sensor.
  TiniPlayer(TiniRobot* robot, const TiniKit* kit, uint8_t* memory, uint16_t bytes,
             int32_t* readings);

  // Copies an image from flash (`image` is `const uint8_t name[] PROGMEM`) and verifies it. Ends
  // what runs. Returns 0, or the number of the reason in `bytecode_spec.md`; kTooLarge where the
  // memory is too small.
  uint8_t load(const uint8_t* image, uint16_t length);

  // Verifies an image that lies in `memory` already.
  uint8_t check(uint16_t length);

  // Begins the image that was loaded. `seed` is where RANDOM begins, not 0.
  void start(uint32_t now_ms, uint32_t seed = 1);

  // Runs code that is verified and has its ends after it.
  void start_code(const uint8_t* code, uint16_t length, uint32_t now_ms, uint32_t seed);

  // Goes on a little; call it in each turn of loop(), with millis().
  void tick(uint32_t now_ms);

  // Ends the program, with the motors off.
  void stop();

  bool is_running() const { return is_running_; }

  // The fault that has ended the last program, or kNone, and where it was.
  tiniscript::Fault fault() const { return fault_; }
  uint16_t fault_at() const { return machine_.offset(); }

  // Where the SHOW is whose value `show` gets now.
  uint16_t shown_at() const { return machine_.shown_at(); }

  TiniRobot* robot() const { return robot_; }
  const TiniKit& kit() const { return *kit_; }
  uint8_t* memory() const { return memory_; }
  uint16_t room() const { return bytes_; }

  // Where values go instead of to the robot: a link sets that.
  typedef bool (*Show)(int32_t value, bool is_yes_no);
  void show_by(Show show) { show_ = show; }
  Show show() const { return show_; }

  static constexpr uint8_t kTooLarge = 255;

 private:
  TiniRobot* robot_;
  const TiniKit* kit_;
  uint8_t* memory_;
  uint16_t bytes_;
  int32_t* readings_;
  tiniscript::Machine machine_;
  tiniscript::Image image_;
  tiniscript::Fault fault_;
  bool is_loaded_;
  bool is_running_;
  Show show_;
};
