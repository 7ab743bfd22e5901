// The link over the USB cable: `tsc upload prog.ts --port P --baud 115200`, `tsc live`, `tsc stop`.
//
// The robot has no sensor; its motors are the two of the example ImageInFlash. What is sent stays
// in RAM. `tsc doctor --conform --port P --baud 115200` tests it.

#include <TiniMotor.h>
#include <TiniScriptLink.h>

const TiniMotor left_motor = {5, 4}, right_motor = {6, 7};  // pins: PWM, and which way

class Robot : public TiniRobot {
 public:
  void motors(int8_t left, int8_t right) override {
    left_motor.drive(left);
    right_motor.drive(right);
  }
};

Robot robot;
const TiniKit kit = {nullptr, 0, 0};
uint8_t memory[300];
TiniPlayer player(&robot, &kit, memory, sizeof memory, nullptr);
TiniLink robot_link(&player, "Own", 0x12345678);

void setup() {
  Serial.begin(115200);
  left_motor.begin();
  right_motor.begin();
  uint32_t random = micros();
  for (int k = 0; k < 32; k++) random = random << 1 ^ static_cast<uint32_t>(analogRead(A5));
  robot_link.begin(random);
}

void loop() {
  while (Serial.available() > 0)
    robot_link.on_rx_byte(static_cast<uint8_t>(Serial.read()), millis());
  robot_link.tick(millis());
  uint8_t byte;
  while (Serial.availableForWrite() > 0 && robot_link.next_tx_byte(&byte)) Serial.write(byte);
}
