// Runs one image on a simulated ATmega328P, for tests, and says over the UART what the robot did.
//
// The request lies in flash: `tests/machines/avr.py` writes it into the built program. The clock
// is simulated as in `run.py`. Ends by sleeping without interrupts: that ends the simulator too.

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <avr/sleep.h>

#include "../src/robot.h"
#include "../src/vm/image.h"
#include "../src/vm/number.h"
#include "../src/vm/verify.h"
#include "../src/vm/vm.h"

using namespace tiniscript;

namespace {

constexpr uint16_t kRequestBytes = 8192;
constexpr uint16_t kImageBytes = 700;
constexpr uint16_t kSlice = 1000;  // instructions between two looks at the limit

// What is found by its first bytes, and written over.
const uint8_t kRequest[kRequestBytes] in_flash = {"TiniScript: here is the request"};

struct Sensor {
  uint16_t name;      // where its name begins; its kind and its readings follow
  uint16_t readings;  // where they begin
  uint16_t count;
  uint16_t taken;
  bool is_yes_no;
};

struct Actuator {
  uint16_t name;
  int32_t low;
  int32_t high;
  bool is_yes_no;
};

uint16_t reading_at = 0;  // of the request
Sensor sensors[8];
Actuator actuators[4];
uint32_t now_ms = 0;
uint8_t image_bytes[kImageBytes + 1];
Machine machine;

uint8_t next_byte() { return flash_byte(kRequest + reading_at++); }

uint16_t next_word() {
  const uint16_t low = next_byte();
  return static_cast<uint16_t>(low | static_cast<uint16_t>(next_byte()) << 8);
}

uint32_t next_long() {
  const uint32_t low = next_word();
  return low | static_cast<uint32_t>(next_word()) << 16;
}

// Skips a text; returns where its length stands.
uint16_t next_text() {
  const uint16_t at = reading_at;
  const uint16_t length = static_cast<uint16_t>(next_long());
  reading_at = static_cast<uint16_t>(reading_at + length);
  return at;
}

void put(char letter) {
  while ((UCSR0A & _BV(UDRE0)) == 0) {
  }
  UDR0 = static_cast<uint8_t>(letter);
}

void put_text(const char* text) {
  while (*text != 0) put(*text++);
}

void put_size(uint32_t size) {
  char digits[10];
  uint8_t count = 0;
  do {
    digits[count++] = static_cast<char>('0' + size % 10);
    size /= 10;
  } while (size != 0);
  while (count != 0) put(digits[--count]);
}

void put_number(int32_t value) {
  if (value < 0) put('-');
  put_size(value < 0 ? 0 - static_cast<uint32_t>(value) : static_cast<uint32_t>(value));
}

// The shortest decimal: `12.5`, `-0.001`, `7`.
void put_value(int32_t value, bool is_yes_no) {
  if (is_yes_no) return put_text(value != 0 ? "TRUE" : "FALSE");
  if (value < 0) put('-');
  const uint32_t size = value < 0 ? 0 - static_cast<uint32_t>(value) : static_cast<uint32_t>(value);
  put_size(size / kOne);
  uint16_t rest = static_cast<uint16_t>(size % kOne);
  if (rest != 0) put('.');
  for (uint16_t unit = 100; rest != 0; unit /= 10) {
    put(static_cast<char>('0' + rest / unit));
    rest %= unit;
  }
}

void put_name(uint16_t at) {
  reading_at = at;
  for (uint32_t left = next_long(); left != 0; left--) put(static_cast<char>(next_byte()));
  put(' ');
}

void begin_line(const char* what) {
  put_size(now_ms);
  put(' ');
  put_text(what);
}

void run(const Image& image, uint8_t sensor_count, uint32_t max_ms, uint32_t max_steps,
         uint32_t seed, uint32_t begin_ms) {
  machine.start(image.code, image.code_length, sensor_count, seed, begin_ms);
  uint32_t left = max_steps;  // before the clock must move
  for (;;) {
    const uint16_t budget = left < kSlice ? static_cast<uint16_t>(left) : kSlice;
    const Status status = machine.tick(now_ms + begin_ms, budget);
    left -= static_cast<uint16_t>(budget - machine.left());
    if (status == Status::kDone) return begin_line("DONE\n");
    if (status == Status::kFault) {
      begin_line("FAULT ");
      if (machine.fault() == Fault::kOverflow) return put_text("OVERFLOW\n");
      if (machine.fault() == Fault::kDivideByZero) return put_text("DIVIDE_BY_ZERO\n");
      return put_text("BAD_CODE\n");
    }
    if (status == Status::kWaiting) {
      const uint32_t wake_ms = machine.task().wake_ms - begin_ms;
      if (wake_ms > max_ms) {
        now_ms = max_ms;
        return begin_line("LIMIT\n");
      }
      if (wake_ms > now_ms) left = max_steps;
      now_ms = wake_ms;
    }
    if (left == 0) return begin_line("LIMIT\n");
  }
}

void answer() {
  const uint16_t kit = next_word();
  const uint32_t max_ms = next_long();
  const uint32_t max_steps = next_long();
  const uint32_t seed = next_long();
  const uint32_t begin_ms = next_long();
  const uint8_t sensor_count = next_byte();
  for (uint8_t k = 0; k < sensor_count; k++) {
    sensors[k].name = next_text();
    sensors[k].is_yes_no = next_byte() != 0;
    sensors[k].count = next_word();
    sensors[k].readings = reading_at;
    reading_at = static_cast<uint16_t>(reading_at + 4 * sensors[k].count);
  }
  const uint8_t actuator_count = next_byte();
  for (uint8_t k = 0; k < actuator_count; k++) {
    actuators[k].name = next_text();
    actuators[k].is_yes_no = next_byte() != 0;
    actuators[k].low = static_cast<int32_t>(next_long());
    actuators[k].high = static_cast<int32_t>(next_long());
  }
  next_long();  // this robot is always ready
  const uint16_t length = static_cast<uint16_t>(next_long());
  if (length > kImageBytes) return put_text("TOO LONG\n");
  for (uint16_t k = 0; k < length; k++) image_bytes[k] = next_byte();
  Image image;
  const Refusal refusal = unpack(image_bytes, length, kit, &image);
  if (refusal != Refusal::kNone) {
    put_text("REFUSED ");
    put_size(static_cast<uint8_t>(refusal));
    return put('\n');
  }
  const Verdict verdict = verify(image.code, image.code_length, sensor_count, actuator_count);
  if (verdict.rule != Rule::kNone) {
    put_text("BREAKS ");
    put_size(static_cast<uint8_t>(verdict.rule));
    put(' ');
    put_size(verdict.offset);
    return put('\n');
  }
  run(image, sensor_count, max_ms, max_steps, seed, begin_ms);
}

}  // namespace

namespace tiniscript {

void robot_motors(int8_t left, int8_t right) {
  begin_line("MOTORS ");
  put_number(left);
  put(' ');
  put_number(right);
  put('\n');
}

void robot_off() {}

bool robot_read(uint8_t sensor, int32_t* value) {
  Sensor& from = sensors[sensor];
  const uint16_t last = static_cast<uint16_t>(from.count - 1);
  const uint16_t index = from.taken < last ? from.taken : last;
  from.taken++;
  reading_at = static_cast<uint16_t>(from.readings + 4 * index);
  *value = from.count == 0 ? 0 : static_cast<int32_t>(next_long());
  begin_line("READ ");
  put_name(from.name);
  put_value(*value, from.is_yes_no);
  put('\n');
  return true;
}

void robot_beep(uint16_t hertz, uint32_t duration_ms) {
  begin_line("BEEP ");
  put_size(hertz);
  put(' ');
  put_size(duration_ms);
  put('\n');
}

bool robot_show(int32_t value, bool is_yes_no) {
  begin_line("SHOW ");
  put_value(value, is_yes_no);
  put('\n');
  return true;
}

void robot_set(uint8_t actuator, int32_t value) {
  const Actuator& to = actuators[actuator];
  if (!to.is_yes_no) {
    const int64_t units = static_cast<int64_t>(whole(value)) * kOne;
    value = units < to.low ? to.low : units > to.high ? to.high : static_cast<int32_t>(units);
  }
  begin_line("SET ");
  put_name(to.name);
  put_value(value, to.is_yes_no);
  put('\n');
}

}  // namespace tiniscript

int main() {
  UCSR0A = _BV(U2X0);
  UCSR0B = _BV(TXEN0);
  UBRR0 = 0;
  answer();
  put_text("END\n");
  while ((UCSR0A & _BV(TXC0)) == 0) {
  }
  cli();
  sleep_mode();
}
