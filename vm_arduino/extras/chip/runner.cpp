#include "runner.h"

#include "../../src/vm/image.h"
#include "../../src/vm/machine.h"
#include "../../src/vm/verify.h"
#include "text.h"

namespace tiniscript {

namespace {

// Instructions between two looks at the limit, or jumps: few, so that programs go on in a new tick
// everywhere.
constexpr uint8_t kSlice = 7;

Machine machine;
int32_t readings[kDevices];

struct Limits {
  uint32_t max_ms;  // less than 2^31
  uint32_t max_steps;
  uint32_t seed;
  uint32_t begin_ms;  // what the machine's clock says at the beginning
};

// The time of the next call: what the program waits for, or a slow sensor, rounded up.
uint32_t next_call_ms(uint32_t wake_ms) {
  const uint32_t now_ms = static_cast<uint32_t>(robot.now_ms);
  // A turn may be due since before: one of a task, or what has waited for a reading.
  if (static_cast<int32_t>(wake_ms - now_ms) < 0) wake_ms = now_ms;
  if (robot.was_slow && wake_ms == now_ms) wake_ms++;
  robot.was_slow = false;
  const uint32_t call_interval_ms = robot.pace.call_interval_ms;
  return (wake_ms + call_interval_ms - 1) / call_interval_ms * call_interval_ms;
}

// Adds the last line of an answer.
void end(const char* word, uint32_t first, uint32_t second) {
  put_text(word);
  put(' ');
  put_size(first);
  put(' ');
  put_size(second);
  put('\n');
}

void say_end(Status status) {
  if (status == Status::kDone) return robot.say("DONE\n");
  robot.say("FAULT ");
  if (machine.fault() == Fault::kOverflow) return put_text("OVERFLOW\n");
  if (machine.fault() == Fault::kDivideByZero) return put_text("DIVIDE_BY_ZERO\n");
  if (machine.fault() == Fault::kNoPower) return put_text("NO_POWER\n");
  put_text("BAD_CODE\n");
}

// Runs code to its end; returns how many instructions ran.
uint32_t run(const Image& image, const Limits& limits) {
  for (int32_t& reading : readings) reading = 0;
  machine.start(image.code, image.code_length, readings, robot.sensor_count, limits.seed,
                limits.begin_ms);
  robot.has_tasks = machine.has_tasks();
  const bool is_at_once = robot.pace.call_interval_ms == 1 && robot.pace.slow_sensors == 0;
  uint32_t steps = 0;
  uint32_t steps_left = limits.max_steps;  // before the clock must move
  for (;;) {
    const uint8_t budget = steps_left < kSlice ? static_cast<uint8_t>(steps_left) : kSlice;
    const uint32_t now_ms = static_cast<uint32_t>(robot.now_ms);
    robot.must_wait = false;
    const Status status = machine.tick(now_ms + limits.begin_ms, budget);
    const uint8_t used_budget = static_cast<uint8_t>(budget - machine.budget_left());
    steps += used_budget;
    steps_left -= used_budget;
    if (status >= Status::kDone) {
      if (!robot.is_off) robot.say("NOT OFF\n");
      // nothing happens any more
      if (machine.tick(now_ms + limits.begin_ms, kSlice) != status) robot.say("GOES ON\n");
      say_end(status);
      return steps;
    }
    if (status == Status::kWaiting || (robot.was_slow && machine.budget_left() != 0)) {
      const uint32_t wake_ms = next_call_ms(machine.wake_ms() - limits.begin_ms);
      if (wake_ms > limits.max_ms) {
        robot.now_ms = limits.max_ms;
        steps_left = 0;
      } else {
        if (wake_ms > now_ms) {
          steps_left = limits.max_steps;
          // a tick that is too early changes nothing
          if (is_at_once) machine.tick(wake_ms - 1 + limits.begin_ms, kSlice);
        }
        robot.now_ms = wake_ms;
      }
    }
    if (steps_left == 0) {
      robot.say("LIMIT\n");
      return steps;
    }
  }
}

// Verifies an image, and answers if it may not run. On an Uno the run needs the stack that this takes.
tini_noinline bool accepts(const uint8_t* data, size_t length, Image* image) {
  uint16_t devices;
  Refusal refusal = unpack(data, length, image);
  if (refusal == Refusal::kNone) {
    const Verdict verdict =
        verify(image->code, image->code_length, robot.sensor_count, robot.actuator_count, &devices,
               image->needs);
    if (verdict.rule != Rule::kNone) {
      end("BREAKS", static_cast<uint8_t>(verdict.rule), verdict.offset());
      return false;
    }
    refusal = check_devices(*image, devices);
  }
  if (refusal != Refusal::kNone) end("REFUSED", static_cast<uint8_t>(refusal), 0);
  return refusal == Refusal::kNone;
}

}  // namespace

void answer_run(Request request, bool is_verified, const Pace& pace) {
  Limits limits;
  limits.max_ms = request.u32();
  limits.max_steps = request.u32();
  limits.seed = request.u32();
  limits.begin_ms = request.u32();
  if (!robot.read(&request)) return put_text("NO ROOM\n");
  robot.pace = pace;
  const size_t length = static_cast<size_t>(request.u32());
  const uint8_t* const data = request_bytes(request.place(), length, kEndBytes);
  if (data == nullptr) return put_text("NO ROOM\n");
  Image image;
  if (!is_verified) {
    image.code = data;
    image.code_length = static_cast<uint16_t>(length);
  } else if (!accepts(data, length, &image)) {
    return;
  }
  const uint32_t steps = run(image, limits);
  end("RAN", machine.offset(), steps);
}

void answer_run_at_pace(Request request) {
  Pace pace;
  pace.call_interval_ms = request.u32();
  pace.slow_sensors = request.u32();
  pace.period_ms = request.u32();
  pace.from_ms = request.u32();
  pace.to_ms = request.u32();
  answer_run(request, true, pace);
}

}  // namespace tiniscript
