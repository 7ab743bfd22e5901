// A robot with an ESP32 on a computer, for tests: the sketch that ships, on a simulated chip.
//
// One process is one robot from a reset to the next. A request is four bytes of length and a letter
// with what it asks; an answer is four bytes of length and what was found.
// `tests/machines/esp32.py` is the other side. Ends with its input.

#include <algorithm>
#include <chrono>

#include "../../src/boards/esp32/protocol_sniffer.h"
#include "../../src/boards/motors.h"
#include "../../src/firmware/board.h"
#include "../host/wire.h"
#include "simulated_chip.h"
#include "simulated_radio.h"
#include "wires.h"

using namespace tiniscript;

namespace {

constexpr uint32_t kTurnUs = 50;    // of the main loop
constexpr size_t kBytesPerMs = 12;  // at 115200 baud

std::string log_of_robot;
PartOutputs last_outputs;

// Since the last request began: turns of the main loop, and those until a motor pin has changed.
typedef std::chrono::steady_clock Watch;
uint32_t turns_begun;
Watch::time_point step_start;
uint32_t turns_until_motion;
uint64_t motion_ns;

void say(const std::string& line) { log_of_robot += line + "\n"; }

void look() {
  const PartOutputs outputs = part_outputs();
  if (outputs.left != last_outputs.left || outputs.right != last_outputs.right) {
    say("MOTORS " + std::to_string(outputs.left) + " " + std::to_string(outputs.right));
    turns_until_motion = turns_begun;
    const Watch::duration turn_time = Watch::now() - step_start;
    motion_ns = static_cast<uint64_t>(std::chrono::nanoseconds(turn_time).count());
  }
  if (outputs.hertz != last_outputs.hertz) say("TONE " + std::to_string(outputs.hertz));
  for (uint8_t k = 0; k < outputs.servos; k++) {
    const uint32_t us = outputs.pulse_us[k];
    if (us != last_outputs.pulse_us[k])
      say("SERVO " + std::to_string(k) + " " + std::to_string(us));
  }
  last_outputs = outputs;
}

void pass(uint32_t us) {
  advance_us(us);
  if (chip.has_restarted) {
    say("RESTART");
    chip.has_restarted = false;
  }
  look();
}

// B: a reset, and what it leaves alone: the bytes of `noinit`, the entries of NVS.
void answer_begin(RequestReader* request, Writer*) {
  chip.reset = static_cast<esp_reset_reason_t>(request->u8());
  chip.random = request->u32();
  set_noinit(request->text());
  for (uint32_t remaining = request->u32(); remaining > 0; remaining--) {
    const std::string key = request->text();
    chip.entries[key] = request->text();
  }
  chip.nvs_fault = static_cast<NvsFault>(request->u8());
  for (uint8_t k = 0; k < 6; k++) chip.mac |= uint64_t{request->u8()} << (8 * k);
  for (SimulatedPin& pin : chip.pins) pin.signal = SIG_GPIO_OUT_IDX;
  initVariant();
  look();
  setup();
  look();
}

void run_turns(uint32_t count) {
  turns_begun = 0;
  step_start = Watch::now();
  for (uint32_t k = 0; k < count; k++) {
    if (chip.slept_us >= kTurnUs) {
      chip.slept_us -= kTurnUs;
      look();
      continue;
    }
    turns_begun++;
    loop();
    pass(kTurnUs);
  }
}

// A millisecond begins, in which bytes arrive.
void receive(const Bytes& data, size_t offset, size_t count) {
  chip.received.append(reinterpret_cast<const char*>(data.data.get()) + offset, count);
  chip.unsent_bytes = chip.unsent_bytes > kBytesPerMs ? chip.unsent_bytes - kBytesPerMs : 0;
}

// S: bytes arrive, the button goes down (1) or up (2), so many turns follow. Says what the robot
// sends and what it does.
void answer_step(RequestReader* request, Writer* answer) {
  request->u32();  // the time: this chip has its own
  const uint8_t flags = request->u8();
  const uint16_t count = request->u16();
  const Bytes bytes = request->bytes();
  receive(bytes, 0, bytes.length);
  if ((flags & 1) != 0) set_button(true);
  if ((flags & 2) != 0) set_button(false);
  run_turns(count);
  answer->text(chip.sent_bytes);
  answer->text(log_of_robot);
  answer->u8(light_is_on());
  answer->u8(motors_are_stopped());
  chip.sent_bytes.clear();
  log_of_robot.clear();
}

// W: so many milliseconds from a time on, so many turns each. Bytes arrive in the first, or one
// in each (1); it ends early once the robot has sent something (2). Says what the robot sends, what
// it does and when, its light, and after each of the milliseconds whether its motors are stopped.
void answer_wait(RequestReader* request, Writer* answer) {
  const uint32_t first_ms = request->u32();
  const uint32_t milliseconds = request->u32();
  const uint16_t count = request->u16();
  const uint8_t mode = request->u8();
  const bool is_spread = mode == 1;
  const Bytes bytes = request->bytes();
  std::string log;
  std::string stopped_flags;
  for (uint32_t k = 0; k < milliseconds; k++) {
    const size_t offset = is_spread || k == 0 ? std::min<size_t>(k, bytes.length) : bytes.length;
    const size_t bytes_left = bytes.length - offset;
    receive(bytes, offset, is_spread ? std::min<size_t>(1, bytes_left) : bytes_left);
    run_turns(count);
    log += with_times(first_ms + k, log_of_robot);
    log_of_robot.clear();
    stopped_flags += static_cast<char>(motors_are_stopped());
    if (mode == 2 && !chip.sent_bytes.empty()) break;
  }
  answer->text(chip.sent_bytes);
  answer->text(log);
  answer->u8(light_is_on());
  answer->text(stopped_flags);
  chip.sent_bytes.clear();
}

// E: what a reset leaves alone.
void answer_surviving_memory(RequestReader*, Writer* answer) {
  answer->text(noinit());
  answer->u32(static_cast<uint32_t>(chip.entries.size()));
  for (const auto& entry : chip.entries) {
    answer->text(entry.first);
    answer->text(entry.second);
  }
  answer->u32(chip.nvs_writes);
}

// H: the main loop stands still for so many milliseconds.
void answer_hang(RequestReader* request, Writer*) {
  for (uint32_t remaining = request->u32(); remaining > 0; remaining--) pass(1000);
}

// A: what an analog pin has, 0 to 4095; D: a digital one; U: how long the echo of a sensor is.
void answer_analog(RequestReader* request, Writer*) {
  const uint8_t pin = request->u8();
  chip.analog[pin] = request->u16();
}

void answer_digital(RequestReader* request, Writer*) {
  const uint8_t pin = request->u8();
  set_input(pin, request->u8() != 0);
}

// K: digital pins that change, each so many microseconds after the one before: pin and level. The
// main loop stands still meanwhile. Says how many edges of each disc the board has counted then.
void answer_edges(RequestReader* request, Writer* answer) {
  for (uint32_t remaining = request->u32(); remaining > 0; remaining--) {
    pass(request->u32());
    const uint8_t pin = request->u8();
    set_input(pin, request->u8() != 0);
  }
  pass(kTurnUs);
  answer->u16(board_edges(false));
  answer->u16(board_edges(true));
}

void answer_echo(RequestReader* request, Writer*) {
  chip.trigger_pin = request->u8();
  chip.echo_pin = request->u8();
  chip.echo_us = request->u32();
}

// R: what happens on the other side of the radios.
void answer_radio(RequestReader* request, Writer* answer) {
  switch (request->u8()) {
    case 'c':
      return answer->u16(low_energy_connect());
    case 'd':
      return low_energy_disconnect(request->u16());
    case 'e':
      return answer->u8(low_energy_is_there(request->u16()));
    case 'm': {
      const uint16_t client = request->u16();
      return low_energy_agree(client, request->u16());
    }
    case 's': {
      const uint16_t client = request->u16();
      return low_energy_subscribe(client, request->u8() != 0);
    }
    case 'w': {
      const uint16_t client = request->u16();
      return low_energy_write(client, request->text());
    }
    case 'k':
      return low_energy_congest(request->u8() != 0);
    case 'n': {
      const std::vector<std::string> notifications = low_energy_notifications(request->u16());
      answer->u32(static_cast<uint32_t>(notifications.size()));
      for (const std::string& notification : notifications) answer->text(notification);
      return;
    }
    case 'C':
      return serial_port_connect(request->u8() != 0);
    case 'E':
      return answer->u8(serial_port_has_client());
    case 'W':
      return serial_port_write(request->text());
    case 'S':
      return answer->text(serial_port_output());
    case 'Z':
      return serial_port_stick(request->u8() != 0);
    case 'R': {
      const std::string name = request->text();
      return network_in_reach(name, request->text());
    }
    case 'N': {
      const std::string name = request->text();
      const std::string address = request->text();
      return network_name(name, address, request->u16());
    }
    case 'X':
      return network_expires();
    case 'l':
      return network_leases_after(request->u32());
    case 'f':
      return network_searches(request->u32());
    case 'L':
      return radio_logs();
    case 't':
      return network_takes(request->u16());
    case 'x':
      return network_refuses(request->u8());
    case 'H':
      chip.is_heap_full = request->u8() != 0;
      return;
    case 'P':
      return answer->u16(network_port());
    case 'I': {
      const RadioSettings settings = radio_settings();
      for (const std::string& setting :
           {settings.advertised, settings.serial_port, settings.host, settings.instance,
            settings.service, settings.network, settings.password}) {
        answer->text(setting);
      }
      answer->u8(settings.is_access_point);
      answer->u32(settings.joins);
      return answer->u32(settings.sockets);
    }
    default:
      abort();
  }
}

// G: whether a connection that begins so is for a robot.
void answer_protocol(RequestReader* request, Writer* answer) {
  const std::string bytes = request->text();
  answer->u8(static_cast<uint8_t>(
      sniff_protocol(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size())));
}

// M: how many turns of the main loop, and nanoseconds of this computer, the last step took until a
// motor pin changed.
void answer_motion_time(RequestReader*, Writer* answer) {
  answer->u32(turns_until_motion);
  answer->u32(static_cast<uint32_t>(motion_ns));
  answer->u32(chip.sleep_count);
}

// C: the line of the cable goes high (0) or low (1), or spoils the next byte (2).
void answer_line(RequestReader* request, Writer*) {
  const uint8_t line_event = request->u8();
  if (line_event == 2) return spoil_byte();
  hold_line(line_event == 1);
}

// X: a panic. What a stack that is not to be relied on would make is not simulated.
void answer_panic(RequestReader*, Writer*) {
  simulated_panic();
  look();
}

// O: what a pin has, 0 to 255. F: whether NVS is full. Z: for how many milliseconds a write of it stops
// the chip. L: LEDC does nothing any more.
void answer_output(RequestReader* request, Writer* answer) { answer->u8(output_of(request->u8())); }

const Answers answers = {
    {'B', answer_begin},
    {'S', answer_step},
    {'W', answer_wait},
    {'E', answer_surviving_memory},
    {'H', answer_hang},
    {'A', answer_analog},
    {'D', answer_digital},
    {'K', answer_edges},
    {'U', answer_echo},
    {'O', answer_output},
    {'R', answer_radio},
    {'C', answer_line},
    {'X', answer_panic},
    {'G', answer_protocol},
    {'M', answer_motion_time},
    {'L', [](RequestReader*, Writer*) { chip.is_ledc_stuck = true; }},
    {'F', [](RequestReader* request, Writer*) { chip.nvs_room = used_entries() + request->u8(); }},
    {'Z', [](RequestReader* request, Writer*) { chip.erase_ms = request->u32(); }},
};

}  // namespace

int main() {
  const bool is_known = answer_all_requests(answers);
  fflush(nullptr);
  _Exit(is_known ? 0 : 1);  // tasks go on until then
}
