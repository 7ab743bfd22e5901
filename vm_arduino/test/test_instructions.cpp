// Every instruction, alone: what it takes, what it leaves, where it goes on, what the robot does.

#include <doctest.h>

#include "../src/vm/vm.h"
#include "cases.h"

using namespace tiniscript;

namespace {

const char* name_of(Status status) {
  switch (status) {
    case Status::kRunning:
      return "running";
    case Status::kWaiting:
      return "waiting";
    case Status::kDone:
      return "done";
    case Status::kFault:
      return "fault";
  }
  return "?";
}

std::string ending(const Machine& machine) {
  switch (machine.fault()) {
    case Fault::kNone:
      return std::to_string(machine.wake_ms());
    case Fault::kOverflow:
      return "OVERFLOW";
    case Fault::kDivideByZero:
      return "DIVIDE_BY_ZERO";
    case Fault::kBadCode:
      return "BAD_CODE";
  }
  return "?";
}

template <typename Value>
std::string row(const std::string& name, const Value* values, size_t count) {
  std::string text = name;
  for (size_t k = 0; k < count; k++) text += " " + std::to_string(values[k]);
  return text + "\n";
}

// All that an instruction can change, as `tools/generate/cpp_cases.py` writes it.
std::string state_of(const Machine& machine, const int32_t* readings, const std::string& trace) {
  const Task& task = machine.task();
  std::string text = "pc " + std::to_string(task.pc) + "\n";
  text += row("stack", task.stack, task.depth);
  text += row("variables", task.variables + 1, 2);
  text += row("readings", readings, cases::eight().sensors.size());
  text += row("counters", task.counters, task.looped);
  text += row("calls", task.calls, task.called);
  text += "watch " + std::to_string(task.move_ms);
  const int8_t powers[] = {task.left, task.right};
  text += row(task.drives ? "" : " wait", powers, task.drives ? 2 : 0);
  if (task.is_watching) text.insert(text.size() - 1, " since " + std::to_string(task.begun_ms));
  text += "random " + std::to_string(task.random) + "\n";
  text += std::string(name_of(machine.status())) + " " + ending(machine) + "\n" + trace;
  return text;
}

}  // namespace

TEST_CASE("every instruction leaves what the machine in Python leaves") {
  const cases::Kit& kit = cases::eight();
  for (const cases::InstructionCase& each : cases::instruction_cases()) {
    robot = TracedRobot();
    robot.sensors = kit.sensors;
    robot.actuators = kit.actuators;
    robot.readings.assign(kit.sensors.size(), {each.reading});
    robot.taken.assign(kit.sensors.size(), 0);
    robot.now_ms = each.now_ms;
    const uint16_t length = static_cast<uint16_t>(each.code.size() - 1);
    std::vector<uint8_t> code = each.code;
    code.resize(length + kEndBytes);
    Machine machine;
    int32_t readings[kDevices] = {};
    machine.start(code.data(), length, readings, static_cast<uint8_t>(kit.sensors.size()), 1, 0);
    machine.tick(each.now_ms, each.steps);
    INFO(each.name);
    CHECK(state_of(machine, readings, robot.trace) == each.state);
  }
}
