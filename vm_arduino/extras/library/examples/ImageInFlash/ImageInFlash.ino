// A program in flash: F(1, 80); R(0.5, 60), compiled by
//
//   tsc compile -e 'F(1, 80); R(0.5, 60)' -o prog.bin
//   xxd -i prog.bin
//
// It runs on two motors of an L298N or an L9110, at the pins below.

#include <TiniMotor.h>
#include <TiniScript.h>

const uint8_t image[] PROGMEM = {@IMAGE@};

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
uint8_t memory[200];
TiniPlayer player(&robot, &kit, memory, sizeof memory, nullptr);

void setup() {
  Serial.begin(115200);
  left_motor.begin();
  right_motor.begin();
  const uint8_t reason = player.load(image, sizeof image);
  if (reason != 0) {
    Serial.print("refused: ");
    Serial.println(reason);
  }
  player.start(millis());
}

void loop() { player.tick(millis()); }
