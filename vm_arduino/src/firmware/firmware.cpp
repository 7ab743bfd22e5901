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

#ifndef tiniscript_transports
Receiver receiver;
#endif

void firmware_begin(const BootInfo& boot_info) {
  robot_status.slot = kNoSlot;
  begin_identity(boot_info);
  store.boot();
#ifdef tiniscript_transports
  link.begin(static_cast<uint8_t>(boot_info.seed & 0xff));
#else
  link.begin(&receiver, static_cast<uint8_t>(boot_info.seed & 0xff));
#endif
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

#ifdef tiniscript_transports

void firmware_on_rx_byte(Transport transport, uint8_t byte, uint16_t time_ms) {
  if (link.receiver(transport).put(byte, time_ms)) board_stop();
}

bool firmware_next_tx_byte(Transport transport, uint8_t* byte) {
  return link.next_tx_byte(transport, byte);
}

bool firmware_has_room(Transport transport) { return link.receiver(transport).has_room(); }

// It counts as a mark until its bytes are there.
void firmware_await_stop(Transport transport, bool is_there) {
  static bool is_awaited[kTransports];
  bool* const its = &is_awaited[static_cast<uint8_t>(transport)];
  Receiver& receiver = link.receiver(transport);
  if (is_there) port_end();
  if (is_there && !*its) receiver.put_mark();
  if (!is_there && *its) receiver.take_mark();
  *its = is_there;
}

Answer port_may_drive(uint8_t type) { return link.may_drive(type); }

bool port_may_press() { return link.may_press(); }

#else

void firmware_on_rx_byte(uint8_t byte, uint16_t time_ms) {
  // Nothing is kept beside the call, so that no register must be saved before it.
  if (near(&receiver)->stops(byte, time_ms)) {
    board_stop();
    return near(&receiver)->keep_last_zero();
  }
  firmware_take_rx_byte(byte, time_ms);
}

void firmware_take_rx_byte(uint8_t byte, uint16_t time_ms) {
  if (near(&receiver)->keep(byte, time_ms)) board_stop();
}

bool firmware_has_tx_byte() { return link.has_tx_byte(); }

bool firmware_next_tx_byte(uint8_t* byte) { return link.next_tx_byte(byte); }

#endif

}  // namespace tiniscript
