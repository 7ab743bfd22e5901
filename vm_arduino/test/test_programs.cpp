// Whole programs: the robot does what `tsc run` prints.

#include <doctest.h>

#include "../src/vm/image.h"
#include "../src/vm/verify.h"
#include "../src/vm/vm.h"
#include "cases.h"

using namespace tiniscript;

namespace {

constexpr uint8_t kBudget = 250;
constexpr uint32_t kMostTicks = 100000;

std::string ending(const Machine& machine) {
  if (machine.status() == Status::kDone) return "DONE";
  if (machine.fault() == Fault::kOverflow) return "FAULT OVERFLOW";
  if (machine.fault() == Fault::kDivideByZero) return "FAULT DIVIDE_BY_ZERO";
  if (machine.fault() == Fault::kNoPower) return "FAULT NO_POWER";
  return machine.status() == Status::kFault ? "FAULT BAD_CODE" : "LIMIT";
}

// Runs code with a simulated clock that jumps from wait to wait.
std::string trace_of(const std::vector<uint8_t>& code, const cases::ProgramCase& program) {
  robot = TracedRobot();
  robot.sensors = program.kit.sensors;
  robot.actuators = program.kit.actuators;
  robot.speed = program.kit.speed;
  robot.turn = program.kit.turn;
  robot.readings = program.readings;
  robot.taken.assign(program.kit.sensors.size(), 0);
  Machine machine;
  const uint8_t sensors = static_cast<uint8_t>(program.kit.sensors.size());
  int32_t readings[kDevices] = {};
  machine.start(code.data(), static_cast<uint16_t>(code.size() - kEndBytes), readings, sensors,
                program.seed, 0);
  for (uint32_t k = 0; k < kMostTicks; k++) {
    const Status status = machine.tick(static_cast<uint32_t>(robot.now_ms), kBudget);
    if (status == Status::kDone || status == Status::kFault) break;
    if (status == Status::kRunning) continue;
    if (machine.wake_ms() > program.max_ms) {
      robot.now_ms = program.max_ms;
      break;
    }
    robot.now_ms = machine.wake_ms();
  }
  robot.say(ending(machine));
  return robot.trace;
}

}  // namespace

TEST_CASE("a robot does what tsc run prints") {
  for (const cases::ProgramCase& each : cases::program_cases()) {
    INFO(each.title);
    std::vector<uint8_t> code(each.image.begin() + kHeaderBytes, each.image.end());
    code.resize(code.size() + kEndBytes);
    CHECK(trace_of(code, each) == each.trace);
  }
}

TEST_CASE("a robot that is not ready is asked again") {
  const cases::ProgramCase& program = cases::program_cases().front();
  const uint8_t code[2 + kEndBytes] = {static_cast<uint8_t>(Op::kRead), 0};
  robot = TracedRobot();
  robot.sensors = cases::tinibot().sensors;
  robot.readings.resize(robot.sensors.size());
  robot.taken.resize(robot.sensors.size());
  robot.not_ready = 1;  // never
  Machine machine;
  int32_t reading = 0;
  machine.start(code, 2, &reading, 1, program.seed, 0);
  CHECK(machine.tick(0, kBudget) == Status::kRunning);
  CHECK(robot.trace == "");
  robot.not_ready = 0;
  robot.must_wait = false;  // it has waited
  CHECK(machine.tick(7, kBudget) == Status::kDone);
  CHECK(robot.trace == "0 READ LIGHT_R 0\n");
}
