#include "firmware.h"

#include "../vm/small.h"
#include "button_hold.h"
#include "identify.h"
#include "identity.h"
#include "persistence.h"
#include "run.h"
#include "state.h"

namespace tiniscript {

RobotStatus robot_status;
uint32_t now_ms;
RobotLink link;
Store store;

void firmware_begin(const BootInfo& boot_info) {
  robot_status.slot = kNoSlot;
  begin_identity(boot_info);
  store.boot();
  begin_link(static_cast<uint8_t>(boot_info.seed & 0xff));
}

void firmware_on_time(uint32_t time_ms) {
  pass_button_hold(static_cast<uint16_t>(time_ms - now_ms));
  now_ms = time_ms;
  link.pass_time(static_cast<uint16_t>(time_ms));
}

void firmware_turn() {
  link.tick();
  tick_run();
  tick_identify();
  link.send_due();
  tick_persistence();
}

bool firmware_has_due_live() { return link.has_due_live(); }

void firmware_tick(uint32_t time_ms) {
  firmware_on_time(time_ms);
  firmware_turn();
}

}  // namespace tiniscript
