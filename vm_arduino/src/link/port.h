// The functions that the link needs of the robot.
//
// Plain functions: each build links one definition of them (a board, a test). None of them blocks.
// `port_defaults.cpp` defines what a robot without discs or breakpoints leaves out.

#pragma once

#include <stdint.h>

#include "../vm/build.h"
#include "messages.h"

namespace tiniscript {

// Sent as it lies in memory: little-endian, without padding.
#define tini_packed __attribute__((packed))

// The robot's identity. `features` has kTextLevel and the other bits: the link sets those that say
// who may drive. `nonce` changes with each reset.
struct tini_packed Identity {
  uint16_t kit;
  uint32_t id;
  uint32_t nonce;
  uint8_t features;
  uint8_t more_features;  // kByTeacher and on are here: two bytes take less code than a number
                          // of both
  Reset reset;
};

// The robot's state and program.
struct tini_packed RobotStatus {
  State state;
  uint8_t run;       // counts started programs
  uint32_t program;  // checksum of the image that START starts
  uint16_t length;   // of its code
  uint8_t slot;      // where it is saved
  Saved saved;
  // The last fault or 0, its offset and its image.
  uint8_t fault;
  uint16_t fault_at;
  uint32_t fault_program;
};

// Errors of the UART: bytes without a stop bit, and the number of overruns. The counters wrap
// around to 0; without a UART they stay 0.
struct LineErrors {
  uint8_t framing;
  uint8_t overrun;
};

// The motor trim. `wheels` has kExchanged and the other bits; then the percent by which the left
// wheel is too strong (negative: the right one), and the percent at which a wheel starts to move.
struct tini_packed Trim {
  uint8_t wheels;
  int8_t balance;
  uint8_t least;
};

// The measured speed of the robot at 40 and 80 %: hundredths of a centimetre, or of a degree, in a
// second. Zeros: not measured, and the kit's numbers hold.
struct tini_packed Pace {
  struct tini_packed Line {
    uint16_t at40;
    uint16_t at80;
  } lines[2];  // ahead, turning
};

// Both, as messages and the robot's memory have them.
struct tini_packed Tuning {
  Trim trim;
  Pace pace;
};

// The state of a remote control, as in KEYS: a bit for each key that is held, and its pad, in
// percent to the right and up.
constexpr uint8_t kRemoteKeys = 6;
struct tini_packed RemoteKeys {
  uint8_t keys;
  int8_t pad[2];
};

constexpr uint8_t kFaultBytes = 7;     // of a RobotStatus, from `fault` on
constexpr uint8_t kFeaturesBytes = 2;  // of an Identity, from `features` on
constexpr uint8_t kMoreByTeacher = kByTeacher >> 8;
constexpr uint8_t kMoreSeals = kSeals >> 8;
constexpr uint8_t kMoreWifiRests = kWifiRests >> 8;
constexpr uint8_t kMoreBreakpoints = kHasBreakpoints ? kBreakpoints >> 8 : 0;
constexpr uint8_t kMoreReadings = kTellsReadings ? kReadings >> 8 : 0;

// The robot's name.
struct DeviceInfo {
  uint8_t name_length;
  uint8_t name[kNameBytes];
};

const DeviceInfo& port_device_info();

// The number of readings and actuators that programs have.
uint8_t port_readings();
uint8_t port_actuators();

Identity& port_identity();
const RobotStatus& port_status();
const Tuning& port_tuning();
LineErrors port_line_errors();

// Edges of both discs while no wheel could turn, modulo 256, the left one in the low byte. False: it
// has no discs.
bool port_noise(uint16_t* edges);

// The largest code that fits, after a header of this version.
uint16_t port_room();

// Ends the running program, and has the one in memory saved if that was requested. kBusy if that is
// not finished: the link reports this, and the client tries again. kLowSupply: it waits for enough
// voltage. An image with is_live is kept in memory in addition to the program.
Answer port_prepare_upload(bool is_live);

// Returns room for an image of this length and kEndBytes after it, or nullptr if there is none. Its
// old contents stay intact until port_prepare_upload is called.
uint8_t* port_memory(uint16_t length, bool is_live);

// Whether the second image may be written ahead: the old one does not run, and
// `port_prepare_upload` will not have to wait.
bool port_may_write_ahead();

// The image in memory is overwritten in parts from now on: the robot holds the stored one.
void port_forget();

// The image in memory is verified and complete except for its checksum. `mode` says whether to save
// it.
void port_take(uint8_t mode, bool is_live);

// The taken image has its checksum.
void port_take_checksum(const uint8_t* image);

// Starts the image taken last, or the program that the robot holds.
void port_start(bool is_live);

// Memory for the image of a program that is read as text, with `*room` bytes after its header;
// nullptr if there is none now. Without `has_room`, that is enough only for its beginning.
uint8_t* port_text_memory(uint16_t* room, bool* has_room);

// Memory with enough room, where the program is that the robot holds. Ends what runs; the robot
// holds the stored program from now on. nullptr: a program is still being saved, and what runs goes
// on.
uint8_t* port_text_room(uint16_t* room);

// Whether the image of a program that was read is kept in addition to the program in memory.
bool port_text_is_separate(bool is_for_button);

// Whether port_prepare_upload would be done at once.
bool port_may_prepare_upload(bool is_live);

// The image that was read is verified and complete except for its checksum: it starts at once, or
// the button starts it until power-off.
void port_take_text(uint8_t* image, bool is_for_button);

// Has the robot hold the program before the one that it holds, and has that saved. Ends what runs.
// kNoPrevious: there is none that it can run, and it holds what it held; kBusy: nothing was done.
Answer port_undo();

// Ends what runs.
void port_end();

// Turns the motors off and ends what runs; nothing starts until port_release. Records `fault` if it
// is not 0.
void port_stop(uint8_t fault);
void port_release();

// Whether a stop keeps the robot from starting, until port_release.
inline bool port_is_latched() { return port_status().state >= State::kStopped; }

// The running program: the offset of the byte of its code with which the instruction begins that
// runs or waits, and its image. Valid only while a program runs.
uint16_t port_run_at();

// The offset of the SHOW whose value is shown now. Valid only while there is one.
uint16_t port_shown_at();
const uint8_t* port_run_image();

// A task, as READ_TASKS sends it: how long until its clock is reached, or 0.
struct tini_packed TaskReport {
  TaskState state;
  uint16_t offset;
  uint32_t left_ms;
};

// Sets the breakpoints of the running program, or otherwise of the program that the robot holds:
// offsets of 16 bits. kBadValue: no statement begins at one of them, and nothing has changed;
// kBusy: the link reports this, and the client tries again.
Answer port_set_breakpoints(const uint8_t* places, uint8_t count);
void port_forget_breakpoints();

// Whether the program that runs is halted, and the task that is; its place is `port_run_at`.
bool port_is_halted();
uint8_t port_halted_task();

// Lets it go on.
void port_resume(ResumeHow mode);

// The values of what runs, or nullptr; only while something runs.
const int32_t* port_variables();

// Reports a task of what runs, from 0 on. False: there are no more.
bool port_report_task(uint8_t task, TaskReport* report);

// The readings of a program, as READING sends them.
struct tini_packed ReadingReport {
  uint8_t run;
  uint8_t sensor;  // with kAfterGap
  int32_t value;
  uint16_t ms;
};

// The number of bytes that a port has taken and still sends: for a UART of an AVR, that one and the
// one after it.
constexpr uint8_t kPortBytes = kIsAvr ? 2 : 1;

// Whether a session is told of readings from now on, and whether there is one that has not been told.
// The next one that is to be told, if there is.
void port_tell_readings(bool is_on);
bool port_has_reading();
ReadingReport port_next_reading();

// The length of the image that the robot holds.
uint16_t port_image_length();

// Puts a byte of the image that the robot holds into `*byte`. kBusy or kLowSupply if it is not
// available now: the link reports this, and the client tries again.
Answer port_image_byte(uint16_t offset, uint8_t* byte);

// Whether the client that is connected has shown the teacher's key.
inline bool is_teacher() { return (port_identity().more_features & kMoreByTeacher) != 0; }

// Whether lines of text may drive the robot.
inline bool text_may_drive() {
  return (port_identity().features & (kOwned | kTextAllowed)) != kOwned;
}

// Whether the session of this request type, or of this line of text (0), may drive the robot now;
// otherwise the reason. A robot with one transport has one session.
Answer port_may_drive(uint8_t type);
inline Answer may_drive(uint8_t type) {
  return kHasTransports ? port_may_drive(type) : Answer::kOk;
}

// Whether a line of text that only presses keys may do so now.
bool port_may_press();
inline bool may_press() { return !kHasTransports || port_may_press(); }

// Whether the running program has read a remote control.
bool port_reads_keys();

// The robot's report on its WiFi, or on its broker. `address` is as four bytes in their order.
struct WifiReport {
  WifiMode mode;
  WifiState state;
  uint8_t address[4];
  uint8_t network_bytes;
  uint8_t network[kNetworkBytes];
};

// The kind of step requested.
WifiReport port_wifi_report(WifiStep step);

// Does a step of setting WiFi. kSaving: it is kept as soon as the motors stand.
Answer port_set_wifi(WifiStep step, const uint8_t* text, uint8_t length);

// Whether a key is one: not zeros alone (`link_owners.cpp`).
bool is_key(const uint8_t* key);

// Puts a key of the robot into `key`, zeros if it has none. kBusy: not available now; kSaving and
// kLowSupply: another one is being saved.
Answer port_key(uint8_t kind, uint8_t* key);

// Has a key saved; zeros take it away. kSaving: it has begun, and `port_key` tells it when it is
// saved; kNotKept: the memory is worn out, and it is tried again; kBusy: nothing was done.
Answer port_keep_key(uint8_t kind, const uint8_t* key);

// Blinks, and plays the tune of the id unless a program runs.
void port_identify();

// Sets the name and has it saved. kOk: saved; kSaving and kLowSupply: set and to be saved;
// kNotKept: the memory is worn out; kBusy: nothing was done. The link reports this, and the client
// tries again.
Answer port_rename(const uint8_t* name, uint8_t length);

// The same for a trim, or for both; also kBadValue.
Answer port_tune(const Tuning& new_tuning, bool has_pace);

}  // namespace tiniscript
