// Settings of a radio: one entry of NVS, so a power cut leaves those before or the new ones.
//
// The main loop keeps them; one task of a radio takes them after each change. `Settings` is plain
// bytes, of which `kept_bytes()` are in NVS, and `is_sound()` says whether these may be used.

#pragma once

#include <nvs.h>
#include <stddef.h>
#include <stdint.h>

#include "../../link/messages.h"
#include "pins.h"

namespace tiniscript {

template <class Settings>
class KeptSettings {
 public:
  explicit constexpr KeptSettings(const char* key)
      : key_(key), changes_(0), seen_changes_(0), current_() {}

  // The main loop calls these four. `load` is called once, before there is a task.
  void load() {
    size_t length = sizeof current_;
    nvs_handle_t handle;
    bool is_there = nvs_open(kNamespace, NVS_READWRITE, &handle) == ESP_OK;
    if (is_there) {
      is_there = nvs_get_blob(handle, key_, &current_, &length) == ESP_OK && current_.is_sound() &&
                 length == current_.kept_bytes();
      nvs_close(handle);
    }
    if (is_there) {
      changes_ = 1;
    } else {
      __builtin_memset(&current_, 0, sizeof current_);
    }
  }

  Answer keep(const Settings& settings) {
    nvs_handle_t handle;
    if (nvs_open(kNamespace, NVS_READWRITE, &handle) != ESP_OK) return Answer::kNotKept;
    const bool is_kept = nvs_set_blob(handle, key_, &settings, settings.kept_bytes()) == ESP_OK &&
                         nvs_commit(handle) == ESP_OK;
    nvs_close(handle);
    if (!is_kept) return Answer::kNotKept;
    use(settings);
    return Answer::kOk;
  }

  // It does not survive a reset.
  void use(const Settings& settings) {
    {
      const CriticalSection critical;
      current_ = settings;
    }
    __atomic_store_n(&changes_, changes_ + 1, __ATOMIC_RELEASE);  // it has one writer
  }

  const Settings& current() const { return current_; }

  // The task's: whether they have changed since its last call; then they are in `*found`.
  bool take_change(Settings* settings) {
    const uint32_t changes = __atomic_load_n(&changes_, __ATOMIC_ACQUIRE);
    if (changes == seen_changes_) return false;
    {
      const CriticalSection critical;
      *settings = current_;
    }
    __atomic_store_n(&seen_changes_, changes, __ATOMIC_RELEASE);
    return true;
  }

  // For both: whether the task has still to take them.
  bool is_new() const {
    return __atomic_load_n(&changes_, __ATOMIC_ACQUIRE) !=
           __atomic_load_n(&seen_changes_, __ATOMIC_ACQUIRE);
  }

 private:
  static constexpr const char* kNamespace = "tiniscript";

  const char* key_;
  uint32_t changes_;
  uint32_t seen_changes_;  // the task's
  Settings current_;       // written by the main loop, in a critical section
};

}  // namespace tiniscript
