#include "halting.h"

#include "../link/frames.h"
#include "../link/port.h"
#include "../robot.h"
#include "../vm/build.h"
#include "../vm/image.h"
#include "breakpoints.h"
#include "persistence.h"
#include "program.h"
#include "run.h"
#include "state.h"

#ifdef tiniscript_has_breakpoints

namespace tiniscript {

namespace {

Breakpoints breakpoints;
uint32_t places_checksum;  // the checksum of the program that has them
uint32_t held_ms;          // for how long the run has been halted
uint16_t halted_ms;        // when that was counted last
struct {
  bool goes_on : 1;  // from a halt, as soon as a motor may start,
  bool is_step : 1;  // and as a step
} resuming;

uint8_t* code_of(const uint8_t* image) {
  return const_cast<uint8_t*>(image) + image[kHeaderLengthAt];
}

// Whether the machine runs now: time stops for a halted one.
bool runs_on() {
  if (!breakpoints.is_halted()) return true;
  const uint16_t now_16_ms = static_cast<uint16_t>(now_ms);
  held_ms += static_cast<uint16_t>(now_16_ms - halted_ms);
  halted_ms = now_16_ms;
  if (!resuming.goes_on) return false;
  resuming.goes_on = false;
  return true;
}

}  // namespace

// Places are those of one program.
void begin_halting(const uint8_t* image, uint16_t length) {
  held_ms = 0;
  resuming.goes_on = false;
  if (breakpoints.has_places()) link.write_checksum();
  if (breakpoints.has_places() && get32(image + kChecksumAt) != places_checksum) {
    breakpoints.forget_places();
  }
  breakpoints.begin(code_of(image), length);
}

void end_halting() { breakpoints.end(); }

uint32_t machine_ms() { return now_ms - held_ms; }

bool begin_tick() {
  if (!runs_on()) return false;
  if (breakpoints.is_halted()) {
    breakpoints.go_on(machine_of_run(), resuming.is_step);
    machine_of_run().resume();
    machine_of_run().set_motors_again();
  }
  if (breakpoints.are_on()) breakpoints.insert_traps(machine_of_run());
  return true;
}

void end_tick(Status status) {
  if (!breakpoints.are_on() ||
      !breakpoints.remove_traps(&machine_of_run(), status, link.may_halt()))
    return;
  halted_ms = static_cast<uint16_t>(now_ms);
  robot_motors(0, 0);
  link.on_halted();
}

bool are_traps_in() { return breakpoints.has_traps(); }

// -- requests of the link
// ---------------------------------------------------------------------------

Answer port_set_breakpoints(const uint8_t* places, uint8_t count) {
  if (!is_running() && (!has_booted() || !load_program())) return busy_answer();
  link.write_checksum();
  const uint8_t* const image = is_running() ? port_run_image() : program;
  const uint16_t length = get16(image + kCodeLengthAt);
  if (!breakpoints.set(code_of(image), length, places, count)) return Answer::kBadValue;
  places_checksum = get32(image + kChecksumAt);
  return Answer::kOk;
}

void port_forget_breakpoints() { breakpoints.forget_places(); }

bool port_is_halted() { return is_running() && breakpoints.is_halted(); }

uint8_t port_halted_task() { return machine_of_run().turn(); }

void port_resume(ResumeHow mode) {
  resuming.goes_on = port_is_halted();
  resuming.is_step = mode == ResumeHow::kStep;
}

const int32_t* port_variables() { return machine_of_run().task().variables; }

bool port_report_task(uint8_t task, TaskReport* report) {
  if (task > kTasks) return false;
  const TaskRecord& record = machine_of_run().task().records[task];
  const int32_t left_ms = static_cast<int32_t>(record.clock_ms - machine_ms());
  report->offset = machine_of_run().place_of(task);
  report->left_ms = left_ms > 0 ? static_cast<uint32_t>(left_ms) : 0;
  report->state = record.state == 0       ? TaskState::kEnded
                  : record.is(kDrives)    ? TaskState::kDriving
                  : record.is(kIsMoving)  ? TaskState::kBlocked
                  : report->left_ms != 0  ? TaskState::kWaiting
                                          : TaskState::kReady;
  return true;
}

}  // namespace tiniscript

#endif
