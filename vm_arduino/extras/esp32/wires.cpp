#include "wires.h"

#include <math.h>

#include "../../src/boards/kit.h"
#include "simulated_chip.h"

using namespace tiniscript;

namespace {

int percent(double level) { return static_cast<int>(lround(level / 2.55)); }

#if defined(tiniscript_motors_bridge)
int power_of(const Bridge& motor) {
  const bool is_forward = output_of(motor.forward.number) != 0;
  const bool is_backward =
      is_there(motor.backward) ? output_of(motor.backward.number) != 0 : !is_forward;
  if (is_forward == is_backward) return 0;
  return (is_forward ? 1 : -1) * percent(output_of(motor.pwm.pin.number));
}

#elif defined(tiniscript_motors_two_wire)
int power_of(const TwoWire& motor) {
  return percent(output_of(motor.forward.pin.number) - output_of(motor.backward.pin.number));
}
#endif

#ifdef tiniscript_servos
uint32_t pulse_us(const Pwm& servo) {
  const SimulatedPin& pin = chip.pins[servo.pin.number];
  if (pin.signal != signal_of(servo.channel)) return 0;
  const SimulatedChannel& channel = chip.channels[servo.channel];
  return static_cast<uint32_t>((uint64_t{channel.duty} * 20000 + 8192) >> 14);
}

#ifdef tiniscript_motors_servos
int power_of(const TurningServo& motor) {
  const uint32_t us = pulse_us(kServos[motor.number]);
  if (us == 0) return 0;
  const int offset_us = static_cast<int>(us) - motor.still_us;
  return percent((motor.is_reversed ? -offset_us : offset_us) / 2.0);
}
#endif

static_assert(sizeof kServos / sizeof *kServos <= kMaxServos, "more servos than are looked at");
#endif

uint32_t tone() {
  if (!is_there(kBuzzer.pin)) return 0;
  const bool is_joined = chip.pins[kBuzzer.pin.number].signal == signal_of(kBuzzer.channel);
  const SimulatedChannel& channel = chip.channels[kBuzzer.channel];
  return is_joined && channel.duty != 0 ? channel.hertz : 0;
}

}  // namespace

PartOutputs part_outputs() {
  PartOutputs outputs = {};
  outputs.left = power_of(kLeftMotor);
  outputs.right = power_of(kRightMotor);
  outputs.hertz = tone();
#ifdef tiniscript_servos
  for (const Pwm& servo : kServos) outputs.pulse_us[outputs.servos++] = pulse_us(servo);
#endif
  return outputs;
}

bool light_is_on() { return is_there(kLight) && output_of(kLight.number) != 0; }

void set_button(bool is_down) { set_input(kStartButton.number, !is_down); }
