#include "run.h"

#include "../link/frames.h"
#include "../link/port.h"
#include "../robot.h"
#include "../vm/flags.h"
#include "../vm/image.h"
#include "../vm/machine.h"
#include "breakpoints.h"
#include "button_hold.h"
#include "firmware.h"
#include "guide.h"
#include "persistence.h"
#include "program.h"
#include "remote.h"
#include "state.h"
#include "trim.h"

namespace tiniscript {

namespace {

Machine machine;
const uint8_t* run_image;  // of the current or last run
Flag<Bit::kMayStart>
    may_start;  // the button is down and nothing ran or was stopped since: its release starts
Flag<Bit::kStartDue> is_start_due;  // the button was released, but the program was not available
bool has_motors_on;
bool reads_keys;  // the program that runs has read some, where kReadsKeys
Flag<Bit::kPrepared> is_prepared;  // machine and board are reset for a program

#ifdef tiniscript_has_breakpoints
Breakpoints breakpoints;
uint32_t places_program;  // the checksum of the program that has them
uint32_t held_ms;         // for how long the run has been halted
uint16_t halted_ms;       // when that was counted last
struct {
  bool goes_on : 1;  // from a halt, as soon as a motor may start,
  bool is_step : 1;  // and as a step
} resuming;

uint8_t* code_of(const uint8_t* image) {
  return const_cast<uint8_t*>(image) + image[kHeaderLengthAt];
}

// The time of the machine, which stands while it is halted.
uint32_t machine_ms() { return now_ms - held_ms; }

// The run of an image begins. Places are those of one program.
void begin_breakpoints(const uint8_t* image, uint16_t length) {
  held_ms = 0;
  resuming.goes_on = false;
  if (breakpoints.has_places()) link.write_checksum();
  if (breakpoints.has_places() && get32(image + kChecksumAt) != places_program) {
    breakpoints.forget_places();
  }
  breakpoints.begin(code_of(image), length);
}

// Whether the machine runs now: time stands for one that is halted.
bool runs_on() {
  if (!breakpoints.is_halted()) return true;
  const uint16_t time_ms = static_cast<uint16_t>(now_ms);
  held_ms += static_cast<uint16_t>(time_ms - halted_ms);
  halted_ms = time_ms;
  if (!resuming.goes_on) return false;
  resuming.goes_on = false;
  return true;
}

// Lets the machine run, and halts it at a place.
Status tick_machine() {
  if (!runs_on()) return Status::kHalted;
  if (breakpoints.is_halted()) {
    breakpoints.go_on(machine, resuming.is_step);
    machine.resume();
    machine.set_motors_again();
  }
  if (!breakpoints.are_on()) return machine.tick(machine_ms(), kTickBudget);
  breakpoints.put_in(machine);
  const Status status = machine.tick(machine_ms(), kTickBudget);
  if (breakpoints.take_out(&machine, status, link.may_halt())) {
    halted_ms = static_cast<uint16_t>(now_ms);
    robot_motors(0, 0);
    link.halted();
  }
  return status;
}
#else
Status tick_machine() { return machine.tick(now_ms, kTickBudget); }
#endif

// Records a fault.
void fault(uint8_t number, uint16_t at) {
  link.write_checksum();  // the record contains the checksum of its image
  robot_status.fault = number;
  robot_status.fault_at = at;
  robot_status.fault_program = get32(run_image + kChecksumAt);
  keep_fault();
  board_faulted();
}

void abort_run(LinkFault why) {
  stop_run(static_cast<uint8_t>(why));
  link.faulted();
}

void go_on() {
  const Status status = tick_machine();
  if (status == Status::kDone) {
    end_run(State::kIdle, true);
    board_finished();
    link.done();
  } else if (status == Status::kFault) {
    end_run(State::kFaulted);
    fault(static_cast<uint8_t>(machine.fault()), machine.at());
    link.faulted();
  } else if (!link.is_attached() && now_ms - machine.task().started_ms >= board_max_run_ms()) {
    abort_run(LinkFault::kMaxRun);
  }
}

// The part of starting a run that does not depend on the program: done while nothing runs.
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
#ifdef tiniscript_has_breakpoints
  begin_breakpoints(image, length);
#endif
  is_start_due = false;
  may_start = false;
  link.let_go();
  if (kReadsKeys) reads_keys = false;
  guide_begin();
  robot_status.state = State::kRunning;
  robot_status.run++;
  board_release();
  if (link.stop_is_due()) board_stop();  // an earlier stop; a later one closes the latch itself
  show_light();
}

void tick_run() {
  if (board_has_stalled() && is_running()) abort_run(LinkFault::kStall);
  if (is_start_due && load_program() && is_start_due) {
    is_start_due = false;
    if (is_in_memory()) begin_run(program);
  }
  // No motor starts while a commit byte is being written.
  if (!is_running()) {
    guide_tick();
    if (!is_prepared) prepare();
  } else if (!store.is_committing()) {
    guide_tick();
    go_on();
  }
}

void end_run(State state, bool is_done) {
  board_stop();
#ifdef tiniscript_has_breakpoints
  breakpoints.end();
#endif
  guide_end(false);
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
  if (was_running && number != 0) fault(number, machine.at());
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
  link.stopped(Cause::kButton);
}

}  // namespace

void firmware_on_pressed() {
  begin_press();
  press();
}

void firmware_on_held() {
  hold_press();
  if (is_running()) press();
}

void firmware_on_released() {
  end_press();
  if (!may_start || is_long_press() || !has_booted()) return;
  link.drop();
  is_start_due = holds_program();
}

void firmware_on_disconnect() {
  link.expire();
  if (!is_running() || !link.is_attached()) return;
  end_run(State::kStopped);
  link.stopped(Cause::kCable);
}

#ifdef tiniscript_transports
bool firmware_has_key(Transport transport) { return link.has_key(transport); }

void firmware_on_part(Transport transport) {
  if (!link.part(transport) || !is_running()) return;
  end_run(State::kStopped);
  link.stopped(Cause::kCable);
}
#endif

uint16_t port_run_at() { return machine.at(); }

#ifdef tiniscript_has_breakpoints
Answer port_set_breakpoints(const uint8_t* places, uint8_t count) {
  if (!is_running() && (!has_booted() || !load_program())) return not_now();
  link.write_checksum();
  const uint8_t* const image = is_running() ? run_image : program;
  const uint16_t length = get16(image + kCodeLengthAt);
  if (!breakpoints.set(code_of(image), length, places, count)) return Answer::kBadValue;
  places_program = get32(image + kChecksumAt);
  return Answer::kOk;
}

void port_forget_breakpoints() { breakpoints.forget_places(); }

bool port_is_halted() { return is_running() && breakpoints.is_halted(); }

uint8_t port_halted_task() { return machine.turn(); }

void port_resume(ResumeHow how) {
  resuming.goes_on = port_is_halted();
  resuming.is_step = how == ResumeHow::kStep;
}

const int32_t* port_variables() { return machine.task().variables; }

bool port_report_task(uint8_t task, TaskReport* report) {
  if (task > kTasks) return false;
  const TaskRecord& record = machine.task().records[task];
  const int32_t left_ms = static_cast<int32_t>(record.clock_ms - machine_ms());
  report->at = machine.place_of(task);
  report->left_ms = left_ms > 0 ? static_cast<uint32_t>(left_ms) : 0;
  report->state = record.state == 0       ? TaskState::kEnded
                  : record.is(kDrives)    ? TaskState::kDriving
                  : record.is(kIsMoving)  ? TaskState::kBlocked
                  : report->left_ms != 0  ? TaskState::kWaiting
                                          : TaskState::kReady;
  return true;
}
#endif

uint16_t port_shown_at() { return machine.shown_at(); }

const uint8_t* port_run_image() { return run_image; }

// The image may not contain its checksum yet.
bool firmware_runs(Place* place) {
  if (!is_running()) return false;
  const uint8_t* const image = run_image;
  const uint16_t most = image == live ? kLiveImageBytes : kImageBytes;
  const uint16_t length = image_length(image);
#ifdef tiniscript_has_breakpoints
  if (breakpoints.are_in()) {  // then it has its checksum
    place->program = get32(image + kChecksumAt);
  } else
#endif
    place->program = image_checksum(image, length < most ? length : most);
  place->at = machine.at();
  return true;
}

// -- what a program asks ------------------------------------------------------------------------

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

#ifdef tiniscript_has_discs

bool robot_measures() { return board_discs().cm != 0; }

void robot_go(int8_t left, int8_t right, int32_t way) {
  robot_motors(left, right);
  guide_go(left, right, way);
}

void robot_go_on(int8_t left, int8_t right) {
  robot_motors(left, right);
  guide_go_on();
}

Going robot_going(int32_t* way) { return guide_going(way); }

#endif

void robot_motors(int8_t left, int8_t right) {
  const Levels levels = trimmed(port_tuning().trim, left, right);
  has_motors_on = (left | right) != 0;
  guide_end(has_motors_on);
  board_motors(levels.left, levels.right);
}

// Sends a shown value to the connected client.
bool robot_show(int32_t value, bool is_yes_no) { return link.show(value, is_yes_no); }

}  // namespace tiniscript
