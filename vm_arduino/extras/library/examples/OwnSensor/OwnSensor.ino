// A sensor of your own: HEAT is a voltage divider with a thermistor on A0, LAMP a LED on pin 13.
//
//   LOOP(FOREVER); SHOW(HEAT); LAMP(HEAT > 30); W(1); END_LOOP
//
// compiled for a profile with these two devices, in this order: see tsc's robots/*.toml.
// The lines of the kit below must say the same, or the image is refused as OTHER_KIT (10).

#include <TiniScript.h>

const uint8_t image[] PROGMEM = {@IMAGE@};

class Robot : public TiniRobot {
 public:
  bool read(uint8_t sensor, int32_t* value) override {
    (void)sensor;  // there is one alone
    *value = analogRead(A0) * 100000L / 1023;  // 0 to 100, in thousandths
    return true;
  }

  bool show(int32_t value, bool is_yes_no) override {
    if (Serial.availableForWrite() < 16) return false;  // the program waits until there is room
    if (is_yes_no) {
      Serial.println(value != 0 ? "TRUE" : "FALSE");
    } else {
      Serial.println(value / 1000.0, 3);
    }
    return true;
  }

  void set(uint8_t actuator, int32_t value) override {
    (void)actuator;
    digitalWrite(13, value != 0 ? HIGH : LOW);
  }
};

const char* const devices[] = {
    "sensor HEAT number % 0 100000",
    "actuator LAMP yes/no  0 1",
};

Robot robot;
const TiniKit kit = {devices, 1, 1};
uint8_t memory[200];
int32_t readings[1];
TiniPlayer player(&robot, &kit, memory, sizeof memory, readings);

void setup() {
  Serial.begin(115200);
  pinMode(13, OUTPUT);
  const uint8_t reason = player.load(image, sizeof image);
  if (reason != 0) {
    Serial.print("refused: ");
    Serial.println(reason);
  }
  player.start(millis());
}

void loop() { player.tick(millis()); }
