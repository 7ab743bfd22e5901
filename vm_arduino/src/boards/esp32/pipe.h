// Connects the task of a radio with the main loop: bytes in both directions, and the departure of
// clients.
//
// Each direction has one writer and one reader, on different cores: the writer publishes its bytes
// with its index, so neither waits and no lock is needed. The departure of a client is queued among
// its bytes, so that no byte of the next client is taken for its own. The rings of a transport come
// from the heap with its first client, and stay. Bytes without room are lost and counted, but no
// stop is lost: it reaches the main loop outside the ring. The same applies to a stop that waits in
// it.

#pragma once

#include <stddef.h>
#include <stdint.h>

#include "stop_finder.h"

namespace tiniscript {

// A ring for one writer and one reader. One place stays free.
template <class Item, uint16_t kPlaces>
class Ring {
 public:
  // The writer's: how many more bytes find room; false if none does.
  uint16_t room() const {
    const uint16_t read_index = __atomic_load_n(&read_index_, __ATOMIC_ACQUIRE);
    return static_cast<uint16_t>((read_index + kPlaces - write_index_ - 1) % kPlaces);
  }
  bool put(Item item) {
    if (room() == 0) return false;
    items_[write_index_] = item;
    const uint16_t write_index = static_cast<uint16_t>((write_index_ + 1) % kPlaces);
    __atomic_store_n(&write_index_, write_index, __ATOMIC_RELEASE);
    return true;
  }

  // The reader's.
  bool take(Item* item) {
    if (read_index_ == __atomic_load_n(&write_index_, __ATOMIC_ACQUIRE)) return false;
    *item = items_[read_index_];
    const uint16_t read_index = static_cast<uint16_t>((read_index_ + 1) % kPlaces);
    __atomic_store_n(&read_index_, read_index, __ATOMIC_RELEASE);
    return true;
  }
  // Leaves out all bytes before a place that `end` has given, if that is still to come.
  void drop_to(uint16_t place) {
    const uint16_t write_index = __atomic_load_n(&write_index_, __ATOMIC_ACQUIRE);
    const uint16_t dropped_count = static_cast<uint16_t>((place + kPlaces - read_index_) % kPlaces);
    const uint16_t unread_count =
        static_cast<uint16_t>((write_index + kPlaces - read_index_) % kPlaces);
    if (dropped_count <= unread_count) __atomic_store_n(&read_index_, place, __ATOMIC_RELEASE);
  }

  // Anybody's: the place of the next byte.
  uint16_t end() const { return __atomic_load_n(&write_index_, __ATOMIC_ACQUIRE); }

 private:
  uint16_t read_index_;   // written by the reader alone
  uint16_t write_index_;  // written by the writer alone
  Item items_[kPlaces];
};

// How many times one task has notified the other. It wraps around to 0.
class Tally {
 public:
  // The writer's.
  void add() { __atomic_store_n(&count_, static_cast<uint8_t>(count() + 1), __ATOMIC_RELAXED); }

  uint8_t count() const { return __atomic_load_n(&count_, __ATOMIC_RELAXED); }

  // The reader's: whether it has been told since the last call.
  bool take() {
    const uint8_t count = this->count();
    const bool is_new = count != taken_count_;
    taken_count_ = count;
    return is_new;
  }

 private:
  uint8_t count_;
  uint8_t taken_count_;
};

class Pipe {
 public:
  // The radio's task calls `take`. The three before it are called by that or by one other task, the
  // Bluetooth stack's.

  // A client is connected: bytes meant for the one before are discarded. False: there is no memory,
  // and no reader.
  bool begin() {
    if (rings_ == nullptr) {
      Rings* const rings = static_cast<Rings*>(__builtin_calloc(1, sizeof(Rings)));
      if (rings == nullptr) return false;
      __atomic_store_n(&rings_, rings, __ATOMIC_RELEASE);
    }
    const uint16_t turn = static_cast<uint16_t>(client_start_ / kOutPlaces + 1);
    const uint16_t client_start = static_cast<uint16_t>(turn * kOutPlaces + rings_->out.end());
    __atomic_store_n(&client_start_, client_start, __ATOMIC_RELEASE);
    __atomic_store_n(&is_connected_, true, __ATOMIC_RELEASE);
    return true;
  }

  // A byte of the client. The main loop does not see a stop that has lost bytes, or whose state
  // has: if all bytes make a stop, and those that found room do not, the stop goes outside the
  // ring.
  void put(uint8_t byte, uint16_t now_ms) {
    has_client_left_ = false;
    Rings* const rings = this->rings();
    const bool has_room =
        rings != nullptr && rings->in.room() > 1 && rings->in.put(byte);  // one for `end_client`
    if (!has_room) lost_.add();
    if (has_room) queued_count_++;
    const StopKind received_stop = received_finder_.put(byte, now_ms);
    const StopKind queued_stop = has_room ? queued_finder_.put(byte, now_ms) : StopKind::kNothing;
    if (received_stop > queued_stop) return stop(received_stop == StopKind::kOfRun);
    if (queued_stop == StopKind::kStop)
      __atomic_store_n(&stop_end_, queued_count_, __ATOMIC_RELEASE);
    if (queued_stop == StopKind::kOfRun)
      __atomic_store_n(&run_stop_end_, queued_count_, __ATOMIC_RELEASE);
  }

  // The client has left.
  void end_client() {
    __atomic_store_n(&is_connected_, false, __ATOMIC_RELEASE);
    if (!has_client_left_ && rings() != nullptr) {
      received_finder_.begin();
      if (rings()->in.put(kClientLeft)) {
        queued_count_++;
        queued_finder_.begin();
      }
    }
    has_client_left_ = true;  // further ones have no effect until a byte comes
  }

  // A stop of which the main loop gets no byte. `only_running`: it stops a running program only.
  void stop(bool only_running = false) { (only_running ? silent_stops_ : stops_).add(); }

  // The next byte for the client.
  bool take(uint8_t* byte) {
    Rings* const rings = this->rings();
    if (rings == nullptr) return false;
    const uint16_t client_start = __atomic_load_n(&client_start_, __ATOMIC_ACQUIRE);
    if (client_start != followed_start_) rings->out.drop_to(client_start % kOutPlaces);
    followed_start_ = client_start;
    return rings->out.take(byte);
  }

  // The main loop calls these.

  bool is_connected() const { return __atomic_load_n(&is_connected_, __ATOMIC_ACQUIRE); }

  // Whether the client has authenticated: the main loop sets it, the radio's task reads it.
  void note_key(bool has_key) { __atomic_store_n(&has_key_, has_key, __ATOMIC_RELAXED); }
  bool has_key() const { return __atomic_load_n(&has_key_, __ATOMIC_RELAXED); }

  // The next event: a byte, or kParted.
  bool take_rx(uint16_t* item) {
    Rings* const rings = this->rings();
    if (rings == nullptr || !rings->in.take(item)) return false;
    taken_count_++;
    return true;
  }

  // Whether a stop waits in the unread bytes, or one for the current run.
  bool has_stop() const { return is_unread(stop_end_); }
  bool has_run_stop() const { return is_unread(run_stop_end_); }

  bool has_room() const { return rings()->out.room() != 0; }  // of a connected client
  void put_tx(uint8_t byte) { rings()->out.put(byte); }

  // The number of lost bytes. It wraps around to 0.
  uint8_t lost() const { return lost_.count(); }

  // Whether a stop that the main loop does not see in the bytes has come since the last call.
  bool take_stop() { return stops_.take(); }
  bool take_silent_stop() { return silent_stops_.take(); }  // one for the current run

  static constexpr uint16_t kClientLeft = 0x100;

 private:
  static constexpr uint16_t kInPlaces = 1024;
  static constexpr uint16_t kOutPlaces = 512;
  static_assert(65536 % kOutPlaces == 0, "turn and place are in 16 bits");

  struct Rings {
    Ring<uint16_t, kInPlaces> in;
    Ring<uint8_t, kOutPlaces> out;
  };

  bool is_unread(const uint32_t& place) const {
    const uint32_t distance = __atomic_load_n(&place, __ATOMIC_ACQUIRE) - taken_count_;
    return distance != 0 && distance <= kInPlaces;
  }

  Rings* rings() const { return __atomic_load_n(&rings_, __ATOMIC_ACQUIRE); }

  Rings* rings_;
  uint16_t client_start_;    // the place of the client's first byte, and above it which turn that is
  uint16_t followed_start_;  // the reader's: the last one that it has gone to
  bool is_connected_;
  bool has_key_;
  bool has_client_left_;        // the radio's: no byte has come since
  uint32_t queued_count_;       // the radio's: total number of queued bytes and partings
  uint32_t stop_end_;           // how much of that ends with the last stop
  uint32_t run_stop_end_;       // or with the last one for the current run
  uint32_t taken_count_;        // the main loop's: how much it has taken
  StopFinder received_finder_;  // in all bytes of the client
  StopFinder queued_finder_;    // in those that found room
  Tally stops_;
  Tally silent_stops_;
  Tally lost_;
};

}  // namespace tiniscript
