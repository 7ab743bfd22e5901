// Saves two programs in the EEPROM of a simulated ATmega328P, and says what is there.
//
// The request has two images, each after its length. The first is saved. Of the save of the second
// one so many steps are done as the request says, then the robot starts anew; then it is saved.
// Says after each start how many bytes are kept and their checksum, and at the end how many cycles
// the longest call of `tick` took: after a start, and in a save.

#include "../../src/store/store.h"

#include "../../src/store/nvm.h"
#include "../../src/vm/crc32.h"
#include "../../src/vm/image.h"
#include "../avr/simulated.h"

using namespace tiniscript;
using simulated::request;
using simulated::say;

namespace {

constexpr uint16_t kMaxBytes = kImageBytes;

uint8_t image[kMaxBytes];
uint16_t length;
Store store;
uint32_t longest_start;
uint32_t longest_save;

void read_image() {
  length = request.u16();
  for (uint16_t index = 0; index < length; index++) image[index] = request.u8();
}

// Ticks so many times, or to the end.
void run(uint16_t ticks, uint32_t* longest) {
  while (ticks-- != 0 && store.is_busy()) {
    TCNT1 = 0;
    store.tick(true);
    const uint32_t cycles = TCNT1 * 8UL;
    if (cycles > *longest) *longest = cycles;
    while (!nvm_is_ready()) {
    }
  }
}

void start() {
  store.boot();
  run(0xffff, &longest_start);
  uint16_t count = 0;
  uint16_t end =
      store.current_slot(Area::kProgram) == kNoSlot ? 0 : kHeaderBytes;  // what this saves
  uint32_t crc = 0;
  while (count != end) {
    uint8_t byte = 0;
    if (!store.fetch(Area::kProgram, count, &byte)) break;
    if (count == kCodeLengthAt) end = static_cast<uint16_t>(end + byte);
    if (count == kCodeLengthAt + 1) end = static_cast<uint16_t>(end + byte * 256U);
    crc = crc32(crc, &byte, 1);
    count++;
  }
  say("KEPT", count);
  put_text("CRC ");
  put_size(crc);
  put('\n');
}

void save(uint16_t ticks) {
  if (!store.begin_save(image)) put_text("REFUSED\n");
  run(ticks, &longest_save);
  say("STATE", static_cast<uint8_t>(store.state()));
}

}  // namespace

int main() {
  simulated::begin();
  TCCR1B = _BV(CS11);  // a count in eight cycles
  const uint16_t ticks = request.u16();
  const Request first_request = request;
  start();
  read_image();
  save(0xffff);
  start();
  request = first_request;
  read_image();
  read_image();
  save(ticks);
  start();
  request = first_request;
  read_image();
  read_image();
  save(0xffff);
  start();
  say("LONGEST_START", static_cast<int32_t>(longest_start));
  say("LONGEST_SAVE", static_cast<int32_t>(longest_save));
  simulated::end();
}
