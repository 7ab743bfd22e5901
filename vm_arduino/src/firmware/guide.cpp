#include "guide.h"

#ifdef tiniscript_has_discs

#include "board.h"
#include "state.h"
#include "trim.h"

namespace tiniscript {

namespace {

constexpr uint8_t kTurnMs = 10;      // of the controller
constexpr uint16_t kStuckMs = 500;   // a wheel that drives and shows no edge for so long
constexpr uint8_t kStandsMs = 250;   // the other one, for so long, does not turn either
constexpr uint8_t kStillMs = 150;    // one without an edge for so long has stopped
constexpr uint16_t kRestMs = 1000;   // and any does so long after its motor was turned off
constexpr uint8_t kSlowMs = 150;     // one without an edge for so long gets more power
constexpr uint16_t kGivesUpMs = 300;  // a correction without effect
constexpr uint16_t kLongestMs = 1000;  // one at most
constexpr int32_t kEdge = 64;        // positions are in 64ths of the way between two edges
constexpr int32_t kFar = 5 * kEdge;  // so far ahead a wheel gets as little power as may be
constexpr uint8_t kRollMs = 60;      // until the robot has seen how it rolls
constexpr uint8_t kMinRollMs = 10;
constexpr uint8_t kMaxRollMs = 200;
constexpr int8_t kCreep = 35;        // percent: slow, but it moves
constexpr uint8_t kCorrections = 2;  // of one move
constexpr uint8_t kWheels = 2;

enum class Phase : uint8_t {
  kNone,
  kDrives,
  kRolls,
  kCorrects,
  kTaken,   // the motors were turned off by other code, and the wheels roll
  kDriven,  // other code drives
};

struct Wheel {
  int32_t edges;              // that it has gone in the direction of the move
  uint16_t edge_count;        // by the board, when it was last asked
  uint16_t edge_ms;           // when the last edge came,
  uint16_t previous_edge_ms;  // and the one before
  uint16_t two_edges_ms;      // how long the last two took; 0: not known
  uint8_t first_edge_part;    // how far the first one was, in parts of the way between two
  bool is_backward : 1;       // the move
  bool is_returning : 1;      // its motor last drove it against the move
  bool is_standing : 1;       // its motor is off, and it cannot turn
  uint8_t spare_edges;        // edges until it is further than before; after something has taken its
                              // motor: that it may roll
  uint8_t noise;              // edges while it could not turn, modulo 256
  int8_t power;               // in the direction of the move
};

struct Guide {
  Phase phase;
  MoveState state;
  uint8_t corrections;
  int8_t max_power;       // power that the program wants
  int8_t min_power;       // power that moves a wheel
  uint8_t roll_ms;        // a wheel rolls on as far as it would go in this time
  uint16_t turn_ms;       // when the controller last did something
  uint16_t start_ms;      // when the move began
  uint16_t off_ms;        // when both motors were turned off, or other driving or a correction began
  uint16_t off_position;  // where both wheels were then, together, modulo 2^16,
  uint16_t off_roll;      // and how far they were to roll
  int16_t lead_sum;       // sum of the left wheel's leads
  int32_t target;
  uint32_t edge;       // distance of a wheel, or of the robot, between two edges
  Wheel wheels[kWheels];
};

Guide guide;

uint16_t elapsed_ms(uint16_t earlier_ms) {
  return static_cast<uint16_t>(static_cast<uint16_t>(now_ms) - earlier_ms);
}

int32_t clamp(int32_t value, int32_t limit) {
  return value > limit ? limit : value < -limit ? -limit : value;
}

// The position of a wheel at rest: in the middle between two edges, as far as is known.
int32_t rest_position(const Wheel& wheel) {
  return (wheel.edges - 1) * kEdge + wheel.first_edge_part + kEdge / 2;
}

// Changes the result of `rest_position`.
void put(Wheel* wheel, int32_t new_position) {
  new_position -= kEdge / 2;
  wheel->first_edge_part = static_cast<uint8_t>(new_position & (kEdge - 1));
  wheel->edges = (new_position >> 6) + 1;
}

// The position of a turning wheel: after its last edge, as far as the time since then shows.
int32_t position(const Wheel& wheel) {
  int32_t progress = kEdge / 2;
  if (wheel.two_edges_ms != 0 && wheel.power > 0) {
    const uint32_t part = uint32_t{elapsed_ms(wheel.edge_ms)} * (2 * kEdge) / wheel.two_edges_ms;
    progress = part < kEdge ? static_cast<int32_t>(part) : kEdge - 1;
  }
  return rest_position(wheel) + progress - kEdge / 2;
}

// How far a wheel that speeds up to 1 has come: t minus the loss meanwhile.
uint16_t distance_after(uint16_t time_ms) {
  return static_cast<uint16_t>(uint32_t{time_ms} * time_ms / (time_ms + 2 * guide.roll_ms));
}

// A disc stands anywhere between two edges. The length of the first one follows from its time,
// compared with that of the third: wheels speed up as they roll on.
void find_first_edge(Wheel* wheel) {
  const uint16_t first_distance =
      distance_after(static_cast<uint16_t>(wheel->previous_edge_ms - guide.start_ms));
  const uint16_t next_distance =
      static_cast<uint16_t>(distance_after(elapsed_ms(guide.start_ms)) - first_distance);
  const uint32_t first =
      next_distance == 0 ? kEdge : uint32_t{first_distance} * (2 * kEdge) / next_distance;
  wheel->first_edge_part = first < kEdge ? static_cast<uint8_t>(first) : kEdge;
}

// How far it will roll on once its motor is off.
int32_t roll(const Wheel& wheel) {
  if (wheel.two_edges_ms == 0) return 0;
  return static_cast<int32_t>(uint32_t{guide.roll_ms} * (2 * kEdge) / wheel.two_edges_ms);
}

void count(Wheel* wheel, uint16_t edge_count, bool has_two) {
  int16_t edges = static_cast<int16_t>(edge_count - wheel->edge_count);
  if (edges == 0) return;
  wheel->edge_count = edge_count;
  const int16_t steps = edges < 0 ? static_cast<int16_t>(-edges) : edges;
  if (wheel->is_standing) {
    wheel->noise = static_cast<uint8_t>(wheel->noise + steps);
    return;
  }
  if (guide.phase == Phase::kTaken) {
    wheel->is_standing = wheel->spare_edges < steps;
    if (wheel->is_standing) return;
    wheel->spare_edges = static_cast<uint8_t>(wheel->spare_edges - steps);
  } else if (guide.phase == Phase::kNone || guide.phase == Phase::kDriven) {
    wheel->edge_ms = static_cast<uint16_t>(now_ms);
    return;
  }
  // A disc with one channel tells no direction: it is that of the motor.
  const bool is_back = has_two ? wheel->is_backward : wheel->is_returning;
  if (is_back) edges = static_cast<int16_t>(-edges);
  wheel->edges += edges;
  // A hand turns it back, its channels are exchanged, or it only flickers: not its motor.
  if (wheel->power < 0 && edges > 0) return;
  if (wheel->power > 0 && (edges < 0 || wheel->spare_edges != 0)) {
    const int16_t remaining = static_cast<int16_t>(wheel->spare_edges - edges);
    wheel->spare_edges = static_cast<uint8_t>(remaining < 0     ? 0
                                              : remaining > 255 ? 255
                                                                : remaining);
    return;
  }
  if (wheel->edges == 3 && guide.phase == Phase::kDrives) find_first_edge(wheel);
  if (steps == 1) {
    if (wheel->edges > 2) wheel->two_edges_ms = elapsed_ms(wheel->previous_edge_ms);
    wheel->previous_edge_ms = wheel->edge_ms;
  } else {
    wheel->two_edges_ms =
        static_cast<uint16_t>(elapsed_ms(wheel->edge_ms) * 2 / static_cast<uint16_t>(steps));
    wheel->previous_edge_ms = static_cast<uint16_t>(now_ms);
  }
  wheel->edge_ms = static_cast<uint16_t>(now_ms);
}

// Whether a move has the motors.
bool is_moving() {
  return guide.phase == Phase::kDrives || guide.phase == Phase::kRolls ||
         guide.phase == Phase::kCorrects;
}

bool are_off() {
  return guide.phase == Phase::kNone || guide.phase == Phase::kRolls ||
         guide.phase == Phase::kTaken;
}

void count() {
  const bool has_two = board_discs().has_two;
  const bool are_at_rest = are_off() && elapsed_ms(guide.off_ms) >= kRestMs;
  for (uint8_t k = 0; k < kWheels; k++) {
    Wheel* const wheel = guide.wheels + k;
    if (are_at_rest) wheel->is_standing = true;
    count(wheel, board_edges(k != 0), has_two);
  }
}

int8_t signed_power(const Wheel& wheel) {
  return wheel.is_backward ? static_cast<int8_t>(-wheel.power) : wheel.power;
}

void set_motors() {
  const Levels levels = trimmed_levels(port_tuning().trim, signed_power(guide.wheels[0]),
                                       signed_power(guide.wheels[1]));
  board_steer(levels.left, levels.right);
}

// Whether its motor drives the wheel, and it has shown no edge for so long.
bool is_slow(const Wheel& wheel, uint16_t limit_ms) {
  return wheel.power != 0 && elapsed_ms(wheel.edge_ms) >= limit_ms;
}

bool is_slow(uint16_t limit_ms) {
  return is_slow(guide.wheels[0], limit_ms) || is_slow(guide.wheels[1], limit_ms);
}

void end(MoveState state) {
  guide.phase = Phase::kNone;
  guide.state = state;
}

void turn_off() {
  const Wheel& left = guide.wheels[0];
  const Wheel& right = guide.wheels[1];
  guide.off_position = static_cast<uint16_t>(position(left) + position(right));
  guide.off_roll =
      guide.phase == Phase::kDrives ? static_cast<uint16_t>(roll(left) + roll(right)) : 0;
  for (Wheel& wheel : guide.wheels) wheel.power = 0;
  set_motors();
  guide.off_ms = static_cast<uint16_t>(now_ms);
  guide.phase = Phase::kRolls;
}

// Other code has the motors: how far may a wheel as fast as this one roll on?
void let_roll(Wheel* wheel) {
  const uint16_t least_ms = static_cast<uint16_t>(2 * elapsed_ms(wheel->edge_ms));
  if (wheel->is_returning || wheel->is_standing) wheel->two_edges_ms = 0;
  if (wheel->two_edges_ms != 0 && wheel->two_edges_ms < least_ms) wheel->two_edges_ms = least_ms;
  const int32_t max_edges = clamp(roll(*wheel) * 2 / kEdge, 250) + 2;
  wheel->spare_edges = wheel->is_standing ? 0 : static_cast<uint8_t>(max_edges);
  wheel->is_standing = false;
  wheel->power = 0;
}

// The distance that the wheels would have rolled by now without other driving is part of the move.
void coast() {
  uint16_t coast_ms = elapsed_ms(guide.off_ms);
  if (coast_ms > 2 * guide.roll_ms) coast_ms = static_cast<uint16_t>(2 * guide.roll_ms);
  for (Wheel& wheel : guide.wheels) {
    if (wheel.two_edges_ms == 0) continue;
    put(&wheel, rest_position(wheel) +
                    static_cast<int32_t>(uint32_t{coast_ms} * kEdge / wheel.two_edges_ms));
    wheel.two_edges_ms = 0;
  }
}

void drive() {
  Wheel* const left = guide.wheels;
  Wheel* const right = guide.wheels + 1;
  const int32_t left_position = position(*left);
  const int32_t right_position = position(*right);
  const int32_t lead = left_position - right_position;
  const int32_t remaining = guide.target - (left_position + right_position) / 2;
  if (remaining <= (roll(*left) + roll(*right)) / 2) return turn_off();
  if (lead <= kFar && lead >= -kFar) {  // more is no motor's: somebody holds the other wheel
    guide.lead_sum = static_cast<int16_t>(clamp(guide.lead_sum + lead, 24000));
  }
  // in 256ths of the power
  const int32_t correction = clamp((lead * 12 + guide.lead_sum / 8) / 64, 64);
  int32_t power = guide.min_power + (remaining / kEdge - 2) * 4;
  if (power < guide.min_power) power = guide.min_power;
  if (power > guide.max_power) power = guide.max_power;
  int32_t left_power = power * (256 - correction);
  int32_t right_power = power * (256 + correction);
  const int32_t higher_power = left_power > right_power ? left_power : right_power;
  if (higher_power > 100 * 256) {
    left_power = left_power * 100 / (higher_power / 256);
    right_power = right_power * 100 / (higher_power / 256);
  }
  left->power = static_cast<int8_t>((left_power + 128) / 256);
  right->power = static_cast<int8_t>((right_power + 128) / 256);
  set_motors();
}

// Lets the wheels be driven from now on, and counts from here.
void begin_to_drive(uint16_t standstill_ms) {
  for (uint8_t k = 0; k < kWheels; k++) {
    Wheel& wheel = guide.wheels[k];
    wheel.edge_count = board_edges(k != 0);
    wheel.edge_ms = static_cast<uint16_t>(now_ms);
    wheel.previous_edge_ms = static_cast<uint16_t>(now_ms - standstill_ms);
    wheel.two_edges_ms = 0;
    wheel.is_returning = wheel.is_standing = false;
    wheel.spare_edges = 0;
    wheel.power = 0;
  }
  guide.phase = Phase::kDrives;
  guide.state = MoveState::kMoving;
  guide.turn_ms = static_cast<uint16_t>(now_ms);
  drive();
}

// Both motors are off: waits until the wheels stand, and looks where they are. A disc that flickers
// does not say it.
void settle() {
  const uint16_t off_ms = elapsed_ms(guide.off_ms);
  if (off_ms >= kRestMs) return end(MoveState::kArrived);
  if (off_ms < kStillMs) return;
  bool misses_target = false;
  uint16_t place_of_both = 0;
  for (const Wheel& wheel : guide.wheels) {
    if (elapsed_ms(wheel.edge_ms) < kStillMs) return;
    const int32_t missing = guide.target - rest_position(wheel);
    if (missing >= kEdge || missing <= -kEdge) misses_target = true;
    place_of_both = static_cast<uint16_t>(place_of_both + rest_position(wheel));
  }
  const int16_t measured_roll = static_cast<int16_t>(place_of_both - guide.off_position);
  if (guide.off_roll > 0 && measured_roll > 0) {  // the next move knows better
    const int32_t expected_roll = guide.off_roll;
    const int32_t new_roll_ms =
        guide.roll_ms * (3 * expected_roll + measured_roll) / (4 * expected_roll);
    guide.roll_ms = static_cast<uint8_t>(new_roll_ms < kMinRollMs  ? kMinRollMs
                                         : new_roll_ms > kMaxRollMs ? kMaxRollMs
                                                                     : new_roll_ms);
  }
  if (!misses_target || guide.corrections == kCorrections) {
    return end(MoveState::kArrived);
  }
  guide.corrections++;
  guide.phase = Phase::kCorrects;
  guide.off_ms = static_cast<uint16_t>(now_ms);
  for (Wheel& wheel : guide.wheels) {
    const int32_t missing = guide.target - rest_position(wheel);
    wheel.two_edges_ms = 0;
    wheel.edge_ms = static_cast<uint16_t>(now_ms);
    wheel.is_standing = missing < kEdge && missing > -kEdge;
    if (wheel.is_standing) continue;
    wheel.spare_edges = 0;
    wheel.is_returning = missing < 0;
    wheel.power = missing < 0 ? static_cast<int8_t>(-guide.min_power) : guide.min_power;
  }
  set_motors();
}

// Each wheel goes on, or back, by itself.
void correct() {
  bool is_over = true;
  for (Wheel& wheel : guide.wheels) {
    const int32_t missing = guide.target - rest_position(wheel);
    if (wheel.power > 0 ? missing < kEdge : missing > -kEdge) wheel.power = 0;
    if (wheel.power != 0) is_over = false;
  }
  if (is_over || is_slow(kGivesUpMs) || elapsed_ms(guide.off_ms) >= kLongestMs) return turn_off();
  set_motors();
}

}  // namespace

void guide_begin() { guide.lead_sum = 0; }

void guide_go(int8_t left, int8_t right, int32_t distance) {
  const Discs discs = board_discs();
  guide.edge = (left ^ right) < 0 ? discs.degrees : discs.cm;
  uint32_t target = static_cast<uint32_t>(distance) / guide.edge;
  uint32_t remainder = static_cast<uint32_t>(distance) % guide.edge;
  for (uint8_t k = 0; k < 12; k++) {  // 64ths of each
    remainder += remainder;
    target += target;
    if (remainder >= guide.edge) {
      remainder -= guide.edge;
      target++;
    }
  }
  guide.target = static_cast<int32_t>(target);
  guide.max_power = left < 0 ? static_cast<int8_t>(-left) : left;
  guide.min_power = guide.max_power < kCreep ? guide.max_power : kCreep;
  guide.corrections = 0;
  if (guide.roll_ms == 0) guide.roll_ms = kRollMs;
  for (Wheel& wheel : guide.wheels) {
    wheel.edges = 0;
    wheel.first_edge_part = kEdge / 2;
  }
  guide.wheels[0].is_backward = left < 0;
  guide.wheels[1].is_backward = right < 0;
  guide.start_ms = static_cast<uint16_t>(now_ms);
  begin_to_drive(0);
}

void guide_go_on() {
  coast();
  begin_to_drive(kStillMs);
}

MoveState guide_move_state(int32_t* remaining) {
  if (guide.phase == Phase::kDriven) coast();
  const int32_t missing = guide.target - (position(guide.wheels[0]) + position(guide.wheels[1])) / 2;
  const uint32_t target_distance = missing > 0 ? static_cast<uint32_t>(missing) : 0;
  *remaining = static_cast<int32_t>((target_distance >> 12) * guide.edge +
                                    (((target_distance & 4095) >> 2) * guide.edge >> 10));
  return guide.state;
}

uint16_t guide_noise() {
  return static_cast<uint16_t>(guide.wheels[0].noise | guide.wheels[1].noise << 8);
}

void guide_end(bool is_driven) {
  const bool was_driven = guide.phase == Phase::kDriven;
  if (was_driven == is_driven && !is_moving()) return;
  count();
  if (was_driven) {
    coast();
    guide.phase = Phase::kNone;
  } else {
    for (Wheel& wheel : guide.wheels) {
      if (is_driven) put(&wheel, position(wheel));
      let_roll(&wheel);
    }
    guide.phase = is_driven ? Phase::kDriven : Phase::kTaken;
  }
  guide.off_ms = static_cast<uint16_t>(now_ms);
}

void guide_tick() {
  if (board_discs().cm == 0) return;
  count();
  if (!is_moving() || elapsed_ms(guide.turn_ms) < kTurnMs) return;
  guide.turn_ms = static_cast<uint16_t>(now_ms);
  if (guide.phase == Phase::kRolls) return settle();
  if (is_slow(kSlowMs) && guide.min_power < guide.max_power) guide.min_power++;
  if (guide.phase == Phase::kCorrects) return correct();
  if (is_slow(kStuckMs)) {
    const bool is_left_slow = is_slow(guide.wheels[0], kStandsMs);
    const bool is_right_slow = is_slow(guide.wheels[1], kStandsMs);
    turn_off();
    return end(is_left_slow && is_right_slow ? MoveState::kStuck
               : is_left_slow                ? MoveState::kStuckLeft
                                             : MoveState::kStuckRight);
  }
  drive();
}

// -- requests of the link and of a program --------------------------------------------------------

bool port_noise(uint16_t* edges) {
  if (board_discs().cm == 0) return false;
  *edges = guide_noise();
  return true;
}

bool robot_measures() { return board_discs().cm != 0; }

void robot_go(int8_t left, int8_t right, int32_t distance) {
  robot_motors(left, right);
  guide_go(left, right, distance);
}

void robot_go_on(int8_t left, int8_t right) {
  robot_motors(left, right);
  guide_go_on();
}

MoveState robot_move_state(int32_t* remaining) { return guide_move_state(remaining); }

}  // namespace tiniscript

#endif
