#include "links.h"

#include "run_down.h"

#ifdef tiniscript_transports

namespace tiniscript {

namespace {

uint8_t number_of(Message message) { return static_cast<uint8_t>(message); }

}  // namespace

void Links::begin(uint8_t epoch) {
  driver_ = kNobody;
  for (uint8_t place = 0; place < kTransports; place++) {
    links_[place].begin(&receivers_[place], epoch);
    links_[place].begin_challenges(place);
  }
}

void Links::pass_time(uint16_t now_ms) {
  const uint16_t passed_ms = static_cast<uint16_t>(now_ms - now_ms_);
  now_ms_ = now_ms;
  run_down(&driving_ms_, 1, passed_ms);
  for (Link& link : links_) link.pass_time(now_ms);
  if (!is_driven()) driver_ = kNobody;
}

// Asks the identity for the rights of a link's session.
void Links::enter(uint8_t place) {
  current_place_ = place;
  Identity& identity = port_identity();
  identity.features = static_cast<uint8_t>((identity.features & ~kYours) | key_rights_[place]);
  identity.more_features =
      static_cast<uint8_t>((identity.more_features & ~kMoreByTeacher) | teacher_rights_[place]);
}

void Links::leave() {
  const Identity& identity = port_identity();
  key_rights_[current_place_] = identity.features & kYours;
  teacher_rights_[current_place_] = identity.more_features & kMoreByTeacher;
}

void Links::tick() {
  for (uint8_t place = 0; place < kTransports; place++) {
    const State previous_state = port_status().state;
    is_asking_ = false;
    enter(place);
    links_[place].tick();
    leave();
    if (is_asking_ && (is_asking_by_text_ || links_[place].has_done())) drive();
    spread_events(previous_state);
  }
}

// Tells all other sessions how the turn of the current one affects them.
void Links::spread_events(State previous_state) {
  const State state = port_status().state;
  Link& current_link = links_[current_place_];
  const bool is_held_back = current_link.is_held_back();
  const bool was_stopped = current_link.take_was_stopped();
  for (uint8_t place = 0; place < kTransports; place++) {
    if (place == current_place_) continue;
    Link& link = links_[place];
    if (is_held_back != is_held_back_) link.hold_back(is_held_back);
    if (was_stopped) link.discard_text();
    if (state == previous_state) continue;
    if (state == State::kStopped) link.on_stopped(current_link.cause());
    if (state == State::kFaulted) link.on_faulted();
  }
  is_held_back_ = is_held_back;
}

void Links::send_due() {
  for (uint8_t place = 0; place < kTransports; place++) {
    enter(place);
    links_[place].send_due();
    leave();
  }
}

void Links::write_checksum() {
  for (Link& link : links_) link.write_checksum();
}

bool Links::has_due_live() const {
  for (const Link& link : links_) {
    if (link.has_due_live()) return true;
  }
  return false;
}

bool Links::stop_is_due() const {
  for (const Link& link : links_) {
    if (link.stop_is_due()) return true;
  }
  return false;
}

void Links::on_done() {
  for (Link& link : links_) link.on_done();
}

void Links::on_faulted() {
  for (Link& link : links_) link.on_faulted();
}

void Links::on_stopped(Cause cause) {
  for (Link& link : links_) link.on_stopped(cause);
}

void Links::cancel_and_detach() {
  for (Link& link : links_) link.cancel_and_detach();
  driver_ = kNobody;
  is_held_back_ = false;
}

bool Links::is_attached() const {
  for (const Link& link : links_) {
    if (link.is_attached()) return true;
  }
  return false;
}

bool Links::tells_readings() const {
  for (const Link& link : links_) {
    if (link.tells_readings()) return true;
  }
  return false;
}

void Links::expire() {
  for (uint8_t place = 0; place < kTransports; place++) {
    enter(place);
    links_[place].expire();
    leave();
  }
}

void Links::expire_others() {
  const uint8_t current = current_place_;
  leave();
  for (uint8_t place = 0; place < kTransports; place++) {
    if (place == current) continue;
    enter(place);
    links_[place].expire();
    leave();
  }
  enter(current);
}

bool Links::confirm_claim() {
  Link* claimant = nullptr;
  for (Link& link : links_) {
    if (!link.has_asked_for_claim()) continue;
    if (claimant != nullptr) return false;  // the presser is unknown
    claimant = &link;
  }
  return claimant != nullptr && claimant->confirm_claim();
}

void Links::let_go() {
  for (Link& link : links_) link.let_go();
}

const RemoteKeys* Links::remote() const {
  const Link* newest = links_;
  for (const Link& link : links_) {
    if (link.remote_ms() > newest->remote_ms()) newest = &link;
  }
  return newest->remote();
}

// The place of the driver; without one, of the first that receives values; or kNobody.
uint8_t Links::listener() const {
  uint8_t place = driver_;
  for (uint8_t k = 0; place == kNobody && k < kTransports; k++) {
    if (links_[k].takes_values()) place = k;
  }
  return place;
}

bool Links::show(int32_t value, bool is_yes_no) {
  const uint8_t place = listener();
  if (place == kNobody) return true;
  enter(place);
  const bool is_taken = links_[place].show(value, is_yes_no);
  leave();
  return is_taken;
}

bool Links::may_halt() const {
  const uint8_t place = listener();
  return place != kNobody && links_[place].may_halt();
}

void Links::on_halted() {
  const uint8_t place = listener();
  if (place != kNobody) links_[place].on_halted();
}

bool Links::end_session(Transport transport) {
  const uint8_t place = place_of(transport);
  const bool ends_run = links_[place].is_attached();
  enter(place);
  links_[place].give_way();
  links_[place].expire();
  receivers_[place].disconnect();
  links_[place].forget_client();
  leave();
  if (driver_ == place) driver_ = kNobody;
  return ends_run;
}

// Whether the last driver is still heard.
bool Links::is_driven() const {
  return driver_ != kNobody && (driving_ms_ != 0 || links_[driver_].is_heard());
}

// Whether the last driver keeps the others away: one that runs nothing and changes nothing gives
// way, even if its open page is heard.
bool Links::keeps_control() const {
  return driver_ != kNobody && (driving_ms_ != 0 || port_status().state == State::kRunning);
}

// The current session drives from now on: uploads and lines of others are over.
void Links::drive() {
  driving_ms_ = kAuthorityMs;
  if (driver_ == current_place_) return;
  driver_ = current_place_;
  for (uint8_t place = 0; place < kTransports; place++) {
    if (place != current_place_) links_[place].give_way();
  }
}

Answer Links::may_drive(uint8_t type) {
  const bool is_remote = is_network(static_cast<Transport>(current_place_));
  const bool is_owned = (port_identity().features & kOwned) != 0;
  const bool is_text = type == 0;
  const bool is_for_all =
      !is_text && (type < kFirstActing || type == number_of(Message::kIdentify) ||
                   type == number_of(Message::kAuthenticate));
  if (is_remote && (!is_owned || is_text) && (!is_for_all || type == number_of(Message::kFetch))) {
    return Answer::kUnowned;
  }
  if (type == number_of(Message::kWifi)) return is_owned ? Answer::kOk : Answer::kUnowned;
  if (is_for_all || type == number_of(Message::kClaim) || type == number_of(Message::kText)) {
    return Answer::kOk;
  }
  if (type == number_of(Message::kClear) && is_held_back_ && is_teacher()) return Answer::kOk;
  if (driver_ != current_place_ && keeps_control()) return Answer::kOtherDriver;
  if (type == number_of(Message::kKeys)) return Answer::kOk;
  is_asking_ = true;
  is_asking_by_text_ = is_text;
  return Answer::kOk;
}

bool Links::may_press() const {
  if (is_network(static_cast<Transport>(current_place_))) return false;
  return driver_ == current_place_ || !keeps_control();
}

bool Links::take_text_memory() {
  const bool is_remote = is_network(static_cast<Transport>(current_place_));
  for (uint8_t place = 0; place < kTransports; place++) {
    if (place == current_place_ || !links_[place].has_open_text()) continue;
    if (is_remote || !is_network(static_cast<Transport>(place))) return false;
    links_[place].drop_text();  // text typed in a network drives nothing
  }
  return true;
}

}  // namespace tiniscript

#endif  // tiniscript_transports
