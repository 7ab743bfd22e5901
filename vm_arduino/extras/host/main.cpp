// Runs the machine on a computer, for tests: many requests to one process.
//
// A request is four bytes of length and a letter with what it asks; an answer is four bytes of
// length and what was found. `tests/machines/host.py` is the other side. Ends with its input.

#include <stdio.h>

#include "../chip/answers.h"
#include "../../src/vm/crc32.h"
#include "../../src/vm/image.h"
#include "../../src/vm/verify.h"
#include "../../src/vm/vm.h"
#include "traced_robot.h"
#include "wire.h"

using namespace tiniscript;

namespace {

// What `../chip` reads of the request that is answered, and where its answer goes.
std::string asked;
std::unique_ptr<uint8_t[]> bytes_asked;
Writer said;

constexpr uint8_t kSlice = 250;  // instructions between two looks at the limit

const char* name_of(Fault fault) {
  switch (fault) {
    case Fault::kNone:
      return "NONE";
    case Fault::kOverflow:
      return "OVERFLOW";
    case Fault::kDivideByZero:
      return "DIVIDE_BY_ZERO";
    case Fault::kNoPower:
      return "NO_POWER";
    case Fault::kStuck:
      return "STUCK";
    case Fault::kStuckLeft:
      return "STUCK_LEFT";
    case Fault::kStuckRight:
      return "STUCK_RIGHT";
    case Fault::kBadCode:
      return "BAD_CODE";
  }
  return "?";
}

struct Limits {
  uint32_t max_ms;  // less than 2^31
  uint32_t max_steps;
  uint32_t seed;
  uint32_t begin_ms;  // what the machine's clock says at the beginning
};

// Runs code on the traced robot with a simulated clock, as `run` in `run.py` does.
void run(const uint8_t* code, uint16_t length, const Limits& limits, Writer* answer) {
  static Machine machine;
  const uint8_t sensors = static_cast<uint8_t>(robot.sensors.size());
  int32_t readings[kDevices] = {};
  machine.start(code, length, readings, sensors, limits.seed, limits.begin_ms);
  robot.has_tasks = machine.has_tasks();
  uint32_t steps = 0;
  uint32_t before = 0;  // instructions that ran before the clock last moved
  std::string ending;
  while (ending.empty()) {
    const uint32_t more = limits.max_steps - (steps - before);
    const uint8_t budget = more < kSlice ? static_cast<uint8_t>(more) : kSlice;
    robot.must_wait = false;
    const Status status = machine.tick(static_cast<uint32_t>(robot.now_ms) + limits.begin_ms, budget);
    steps += static_cast<uint32_t>(budget - machine.left());
    const uint32_t wake_ms = machine.wake_ms() - limits.begin_ms;
    if (status >= Status::kDone) {
      if (!robot.is_off) robot.say("NOT OFF");
      // nothing happens any more
      if (machine.tick(wake_ms + limits.begin_ms, kSlice) != status) robot.say("GOES ON");
    }
    if (status == Status::kDone) {
      ending = "DONE";
    } else if (status == Status::kFault) {
      ending = std::string("FAULT ") + name_of(machine.fault());
    } else if (status == Status::kWaiting && wake_ms <= limits.max_ms) {
      // A tick that is too early changes nothing.
      if (wake_ms > robot.now_ms) machine.tick(wake_ms - 1 + limits.begin_ms, kSlice);
      if (wake_ms > robot.now_ms) {
        before = steps;
      }
      robot.now_ms = wake_ms;
      if (steps - before >= limits.max_steps) {
        ending = "LIMIT";
      }
    } else if (status == Status::kWaiting) {
      robot.now_ms = limits.max_ms;
      ending = "LIMIT";
    } else if (steps - before >= limits.max_steps) {
      ending = "LIMIT";
    }
  }
  robot.say(ending);
  answer->u16(machine.at());
  answer->u32(steps);
  answer->text(robot.trace);
}

void read_robot(RequestReader* request) {
  robot = TracedRobot();
  for (uint8_t count = request->u8(); count > 0; count--) {
    const std::string name = request->text();
    const bool is_yes_no = request->u8() != 0;
    robot.sensors.push_back({name, is_yes_no, 0, 0, request->u16()});
    std::vector<int32_t> values(request->u16());
    for (int32_t& value : values) value = request->i32();
    robot.readings.push_back(values);
  }
  for (uint8_t count = request->u8(); count > 0; count--) {
    const std::string name = request->text();
    const bool is_yes_no = request->u8() != 0;
    const uint16_t hash = request->u16();
    const int32_t low = request->i32();
    robot.actuators.push_back({name, is_yes_no, low, request->i32(), hash});
  }
  robot.taken.assign(robot.sensors.size(), 0);
  robot.speed = request->u32();
  robot.turn = request->u32();
  robot.not_ready = request->u32();
}

// R: runs an image, which is read and verified first. U: runs the code of an image whatever it is.
void answer_run(RequestReader* request, bool is_verified, Writer* answer) {
  Limits limits;
  limits.max_ms = request->u32();
  limits.max_steps = request->u32();
  limits.seed = request->u32();
  limits.begin_ms = request->u32();
  read_robot(request);
  const Bytes data = request->bytes(kEndBytes);
  Image image;
  if (is_verified) {
    const Refusal refusal = unpack(data.data.get(), data.length, &image);
    answer->u8(static_cast<uint8_t>(refusal));
    if (refusal != Refusal::kNone) return;
    uint16_t devices;
    const Verdict verdict =
        verify(image.code, image.code_length, static_cast<uint8_t>(robot.sensors.size()),
               static_cast<uint8_t>(robot.actuators.size()), &devices, image.needs);
    answer->u8(static_cast<uint8_t>(verdict.rule));
    answer->u16(verdict.offset);
    if (verdict.rule != Rule::kNone) return;
    const Refusal other = check_devices(image, devices);
    answer->u8(static_cast<uint8_t>(other));
    if (other != Refusal::kNone) return;
  } else {
    image.code = data.data.get();
    image.code_length = static_cast<uint16_t>(data.length);
  }
  run(image.code, image.code_length, limits, answer);
}

// L: runs the code of an image whose ticks after a wait come late, each by as much as is asked for:
// the lines before its ending.
void answer_late(RequestReader* request, Writer* answer) {
  std::vector<uint32_t> late_ms(request->u32());
  for (uint32_t& each : late_ms) each = request->u32();
  request->u32();  // longest time
  request->u32();  // most instructions
  const uint32_t seed = request->u32();
  request->u32();  // beginning
  read_robot(request);
  const Bytes data = request->bytes(kEndBytes);
  const size_t length = data.length - kHeaderBytes;
  Machine machine;
  int32_t readings[kDevices] = {};
  machine.start(data.data.get() + kHeaderBytes, static_cast<uint16_t>(length), readings,
                static_cast<uint8_t>(robot.sensors.size()), seed, 0);
  for (const uint32_t late : late_ms) {
    const uint32_t now_ms = static_cast<uint32_t>(robot.now_ms);
    if (machine.tick(now_ms, kSlice) != Status::kWaiting) break;
    const uint32_t more_ms = machine.wake_ms() - now_ms;
    robot.now_ms += (more_ms < 0x80000000 ? more_ms : 0) + uint64_t{late};
  }
  answer->raw(robot.trace);
}

// X: all codes of three bytes that begin with one byte. How many are accepted, how many of these
// fail a run-time check, and the checksum of all verdicts.
void answer_all(RequestReader* request, Writer* answer) {
  const uint8_t sensors = request->u8();
  const uint8_t actuators = request->u8();
  uint8_t code[3 + kEndBytes] = {request->u8()};
  uint32_t accepted = 0;
  uint32_t bad = 0;
  uint32_t checksum = 0;
  for (uint32_t rest = 0; rest < 0x10000; rest++) {
    code[1] = static_cast<uint8_t>(rest >> 8);
    code[2] = static_cast<uint8_t>(rest & 0xff);
    const Verdict verdict = verify(code, 3, sensors, actuators);
    const bool is_accepted = verdict.rule == Rule::kNone;
    const uint16_t offset = is_accepted ? 0 : verdict.offset;
    const uint8_t verdict_said[] = {static_cast<uint8_t>(verdict.rule),
                                    static_cast<uint8_t>(offset), 0};
    checksum = crc32(checksum, verdict_said, sizeof verdict_said);
    if (!is_accepted) continue;
    accepted++;
    robot = TracedRobot();
    robot.sensors.resize(sensors);
    robot.readings.resize(sensors);
    robot.taken.resize(sensors);
    Machine machine;
    int32_t readings[kDevices] = {};
    machine.start(code, 3, readings, sensors, 1, 0);
    uint32_t now_ms = 0;
    for (uint8_t k = 0; k < 20; k++) {
      if (machine.tick(now_ms, 10) == Status::kWaiting) now_ms = machine.wake_ms();
    }
    bad += machine.fault() == Fault::kBadCode;
  }
  answer->u32(accepted);
  answer->u32(bad);
  answer->u32(checksum);
}

}  // namespace

namespace tiniscript {

uint8_t request_byte(size_t place) {
  return place < asked.size() ? static_cast<uint8_t>(asked[place]) : 0;
}

// Bytes of exactly their length, so that a sanitizer detects a read past the end.
const uint8_t* request_bytes(size_t place, size_t length, size_t zeros) {
  bytes_asked.reset(new uint8_t[length + zeros]());
  for (size_t k = 0; k < length; k++) bytes_asked[k] = request_byte(place + k);
  return bytes_asked.get();
}

void put(char letter) { said.u8(static_cast<uint8_t>(letter)); }

}  // namespace tiniscript

int main() {
  while (next_request(&asked)) {
    RequestReader request(asked);
    said = Writer();
    switch (request.u8()) {
      case 'R':
        answer_run(&request, true, &said);
        break;
      case 'U':
        answer_run(&request, false, &said);
        break;
      case 'L':
        answer_late(&request, &said);
        break;
      case 'V':
        answer_verdicts(Request(1), asked.size());
        break;
      case 'X':
        answer_all(&request, &said);
        break;
      case 'I':
        answer_images(Request(1), asked.size());
        break;
      case 'A':
        answer_arithmetic(Request(1), asked.size());
        break;
      default:
        return 1;
    }
    send_answer(said);
  }
  return 0;
}
