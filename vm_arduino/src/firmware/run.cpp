#include "run.h"

#include "../link/frames.h"
#include "../link/port.h"
#include "../robot.h"
#include "../vm/flags.h"
#include "../vm/image.h"
#include "../vm/machine.h"
#include "button_hold.h"
#include "firmware.h"
#include "guide.h"
#include "halting.h"
#include "persistence.h"
#include "program.h"
#include "readings.h"
#include "remote.h"
#include "state.h"
#include "trim.h"

namespace tiniscript {

namespace {

Machine machine;
const uint8_t* run_image;  // of the current or last run
Flag<Bit::kMayStart>
    may_start;  // the button is down and no program ran or was stopped since: its release starts
Flag<Bit::kStartDue> is_start_due;  // the button was released, but the program was not available
bool has_motors_on;
bool reads_keys;  // the program that runs has read some, where kReadsKeys
Flag<Bit::kPrepared> is_prepared;  // machine and board are reset for a program

Status tick_machine() {
  if (!kHasBreakpoints) return machine.tick(now_ms, kTickBudget);
  if (!begin_tick()) return Status::kHalted;
  const Status status = machine.tick(machine_ms(), kTickBudget);
  end_tick(status);
  return status;
}

// Records a fault.
void fault(uint8_t number, uint16_t offset) {
  link.write_checksum();  // the record contains the checksum of its image
  robot_status.fault = number;
  robot_status.fault_at = offset;
  robot_status.fault_program = get32(run_image + kChecksumAt);
  keep_fault();
  board_faulted();
}

void abort_run(LinkFault cause) {
  stop_run(static_cast<uint8_t>(cause));
  link.on_faulted();
}

void go_on() {
  const Status status = tick_machine();
  if (status == Status::kDone) {
    end_run(State::kIdle, true);
    board_finished();
    link.on_done();
  } else if (status == Status::kFault) {
    end_run(State::kFaulted);
    fault(static_cast<uint8_t>(machine.fault()), machine.offset());
    link.on_faulted();
  } else if (!link.is_attached() && now_ms - machine.task().started_ms >= board_max_run_ms()) {
    abort_run(LinkFault::kMaxRun);
  }
}

// The part of starting a run that does not depend on the program: done while no program runs.
void prepare() {
  for (uint8_t k = 0; k < readings_of(board_sensors()); k++) board_readings()[k] = 0;
  board_forget();
  machine.prepare();
  is_prepared = true;
}

}  // namespace

void begin_run(const uint8_t* image) {
  if (!is_prepared) prepare();
  is_prepared = false;
  const uint16_t length = get16(image + kCodeLengthAt);  // in this order fewer registers are saved
  const uint8_t* const code = image + image[kHeaderLengthAt];
  const uint32_t time_ms = now_ms;
  machine.start_prepared(code, length, board_readings(), readings_of(board_sensors()),
                         (time_ms ^ port_identity().nonce) | 1, time_ms);
  run_image = image;
  if (kHasBreakpoints) begin_halting(image, length);
  if (kTellsReadings) begin_readings();
  is_start_due = false;
  may_start = false;
  link.let_go();
  if (kReadsKeys) reads_keys = false;
  if (kHasDiscs) guide_begin();
  robot_status.state = State::kRunning;
  robot_status.run++;
  board_release();
  if (link.stop_is_due()) board_stop();  // an earlier stop; a later one closes the latch itself
  show_light();
}

void tick_run() {
  if (board_take_stall() && is_running()) abort_run(LinkFault::kStall);
  if (is_start_due && load_program() && is_start_due) {
    is_start_due = false;
    if (is_in_memory()) begin_run(program);
  }
  // No motor starts while a commit byte is being written.
  if (!is_running()) {
    if (kHasDiscs) guide_tick();
    if (!is_prepared) prepare();
  } else if (!store.is_committing()) {
    if (kHasDiscs) guide_tick();
    go_on();
  }
}

void end_run(State state, bool is_done) {
  board_stop();
  if (kHasBreakpoints) end_halting();
  if (kHasDiscs) guide_end(false);
  if (!is_done) board_actuators_off();
  robot_off();
  may_start = false;
  is_start_due = false;
  has_motors_on = false;
  robot_status.state = state;
  show_light();
}

void stop_run(uint8_t number) {
  const bool was_running = is_running();
  end_run(number != 0 ? State::kFaulted : State::kStopped);
  if (was_running && number != 0) fault(number, machine.offset());
}

void forget_start() { is_start_due = false; }

bool is_image_running(const uint8_t* image) { return run_image == image && is_running(); }

bool is_driving() { return has_motors_on; }

// -- events -------------------------------------------------------------------------------------

namespace {

void press() {
  may_start = !is_running();
  if (may_start) return;
  end_run(State::kStopped);
  link.on_stopped(Cause::kButton);
}

}  // namespace

void firmware_on_pressed() {
  begin_press();
  press();
}

void firmware_on_down() {
  hold_press();
  if (is_running()) press();
}

void firmware_on_released() {
  end_press();
  if (!may_start || is_long_press() || !has_booted()) return;
  link.cancel_and_detach();
  is_start_due = holds_program();
}

void firmware_on_disconnect() {
  link.expire();
  if (!is_running() || !link.is_attached()) return;
  end_run(State::kStopped);
  link.on_stopped(Cause::kCable);
}

MachineOfRun& machine_of_run() { return machine; }

uint16_t port_run_at() { return machine.offset(); }

uint16_t port_shown_at() { return machine.shown_at(); }

const uint8_t* port_run_image() { return run_image; }

// The image may not contain its checksum yet.
bool firmware_runs(Place* place) {
  if (!is_running()) return false;
  const uint8_t* const image = run_image;
  const uint16_t limit = image == live ? kLiveImageBytes : kImageBytes;
  const uint16_t length = image_length(image);
  if (kHasBreakpoints && are_traps_in()) {  // then it has its checksum
    place->checksum = get32(image + kChecksumAt);
  } else {
    place->checksum = image_checksum(image, length < limit ? length : limit);
  }
  place->offset = machine.offset();
  return true;
}

// -- requests of a program -----------------------------------------------------------------------

bool port_reads_keys() { return kReadsKeys && reads_keys && is_running(); }

int32_t remote_reading(uint8_t number) {
  if (kReadsKeys) reads_keys = true;
  const RemoteKeys* const remote_keys = link.remote();
  if (remote_keys == nullptr) return 0;
  if (number < kRemoteKeys) {
    uint8_t keys = remote_keys->keys;
    for (; number != 0; number--) keys = static_cast<uint8_t>(keys >> 1);
    return keys & uint8_t{1};
  }
  return remote_keys->pad[number - kRemoteKeys] * int32_t{1000};
}

void robot_motors(int8_t left, int8_t right) {
  const Levels levels = trimmed_levels(port_tuning().trim, left, right);
  has_motors_on = (left | right) != 0;
  if (kHasDiscs) guide_end(has_motors_on);
  board_motors(levels.left, levels.right);
}

// Sends a shown value to the connected client.
bool robot_show(int32_t value, bool is_yes_no) { return link.show(value, is_yes_no); }

}  // namespace tiniscript
