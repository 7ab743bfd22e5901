// A program in flash: F(1, 80); R(0.5, 60), compiled by
//
//   tsc compile -e 'F(1, 80); R(0.5, 60)' -o prog.bin
//   xxd -i prog.bin
//
// It runs on two motors of an L298N or an L9110 whose speed pins are those below.

#include <TiniScript.h>

const uint8_t image[] PROGMEM = {@IMAGE@};

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
uint8_t memory[200];
TiniPlayer player(&robot, &kit, memory, sizeof memory, nullptr);

void setup() {
  Serial.begin(115200);
  const int pins[] = {left_forward, left_backward, right_forward, right_backward};
  for (int pin : pins) pinMode(pin, OUTPUT);
  const uint8_t reason = player.load(image, sizeof image);
  if (reason != 0) {
    Serial.print("refused: ");
    Serial.println(reason);
  }
  player.start(millis());
}

void loop() { player.tick(millis()); }
