// The link over the USB cable: `tsc upload prog.ts --port P --baud 115200`, `tsc live`, `tsc stop`.
//
// The robot has no sensor; its motors are the two of the example ImageInFlash. What is sent stays
// in RAM. `tsc conform --port P --baud 115200` tests it.

#include <TiniScriptLink.h>

const int left_forward = 5, left_backward = 4, right_forward = 6, right_backward = 7;

class Robot : public TiniRobot {
 public:
  void motors(int8_t left, int8_t right) override {
    drive(left_forward, left_backward, left);
    drive(right_forward, right_backward, right);
  }

 private:
  void drive(int forward, int backward, int percent) {
    digitalWrite(backward, percent < 0 ? HIGH : LOW);
    const int pwm = percent * 255 / 100;
    analogWrite(forward, percent < 0 ? 255 + pwm : pwm);
  }
};

Robot robot;
const TiniKit kit = {nullptr, 0, 0};
uint8_t memory[300];
TiniPlayer player(&robot, &kit, memory, sizeof memory, nullptr);
TiniLink robot_link(&player, "Own", 0x12345678);

void setup() {
  Serial.begin(115200);
  const int pins[] = {left_forward, left_backward, right_forward, right_backward};
  for (int pin : pins) pinMode(pin, OUTPUT);
  uint32_t random = micros();
  for (int k = 0; k < 32; k++) random = random << 1 ^ static_cast<uint32_t>(analogRead(A5));
  robot_link.begin(random);
}

void loop() {
  while (Serial.available() > 0) robot_link.hear(static_cast<uint8_t>(Serial.read()), millis());
  robot_link.tick(millis());
  uint8_t byte;
  while (Serial.availableForWrite() > 0 && robot_link.next_byte(&byte)) Serial.write(byte);
}
