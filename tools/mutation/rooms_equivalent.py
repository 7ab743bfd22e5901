"""Changes of other rooms than the machine that change nothing, so that no test can notice them: the
line, what it becomes, and why. A short line stands here behind the line before it."""

from __future__ import annotations

# fmt: off
_REASONS: dict[str, tuple[tuple[str, str], ...]] = {
    "what is behind is read next": (
        ("data = self._peer.recv(65536)",
         "data = self._peer.recv(65537)"),
    ),
    "no byte is being written when a save comes to its first step that waits": (
        ("bool Store::is_committing() const { return is_busy_ && !nvm_is_ready() && step_ > waits_from_; }",
         "bool Store::is_committing() const { return is_busy_ && !nvm_is_ready() && step_ >= waits_from_; }"),
    ),
    "a slot under a program of version 0.1.0: at one of 64 generations a save there does not count, is "
    "told by nobody, and is done again": (
        ("if (held == kOverlaid) { held = kNothing;",
         "if (held == kOverlaid) { ;"),
    ),
    "the supply is looked at again after half a second and a millisecond": (
        ("if (is_low && static_cast<uint16_t>(now_ms - low_ms) < kLowMs) return false;",
         "if (is_low && static_cast<uint16_t>(now_ms - low_ms) <= kLowMs) return false;"),
    ),
    "the store is free then, and every program that is held fits: a save has begun": (
        ("if (!has_begun) keeping = 0;  // too large: no such program exists",
         "if (!has_begun) keeping = 1;  // too large: no such program exists"),
    ),
    "what is to be kept has begun in the same turn; where it has not, it is kept after the keys": (
        ("bool may_keep_keys() { return has_booted() && !store.is_busy() && (to_keep | keeping) == 0; }",
         "bool may_keep_keys() { return has_booted() && !store.is_busy() && (to_keep & keeping) == 0; }"),
    ),
    "a button that is down without a press was down since the reset: nothing was counted before": (
        ("phase = Phase::kDownSinceReset; down_ms = 0;",
         "phase = Phase::kDownSinceReset; ;"),
    ),
    "the run prepares itself then: it begins some microseconds later": (
        ("if (!is_running()) { if (!is_prepared) prepare();",
         "if (!is_running()) { ;"),
    ),
    "0 is 0 either way": (
        ("if (number < 0) size = static_cast<uint8_t>(-size);",
         "if (number <= 0) size = static_cast<uint8_t>(-size);"),
        ("if (number < 0) size = static_cast<uint8_t>(-size);",
         "if (number < 1) size = static_cast<uint8_t>(-size);"),
        ("if (weakened > 0)",
         "if (weakened >= 0)"),
    ),
    "a power of 0 has returned before": (
        ("return power < 0 ? static_cast<int16_t>(-found) : found;",
         "return power <= 0 ? static_cast<int16_t>(-found) : found;"),
        ("return power < 0 ? static_cast<int16_t>(-found) : found;",
         "return power < 1 ? static_cast<int16_t>(-found) : found;"),
    ),
    "no percentage has the level 1, and 0 steps missing leave a level as it is": (
        ("if (missing != 0) {",
         "if (missing != 1) {"),
    ),
    "a body ends behind the first statement that does not go on": (
        ("if made and not goes_on(tuple(made[-1:])):",
         "if made and not goes_on(tuple(made[-2:])):"),
    ),
    "a label is marked before anything reads it": (
        ("self.labels.append(-1)",
         "self.labels.append(-2)"),
    ),
    "a session looks at it when a try ends: no try ends in this millisecond": (
        ("DEAF_MS = 3000  # a heartbeat without an answer for this time means that the link is lost",
         "DEAF_MS = 3001  # a heartbeat without an answer for this time means that the link is lost"),
    ),
    "settling uses neither, and whoever writes sets both": (
        ("for (uint8_t& held : held_) held = kNothing; length_ = 0;",
         "for (uint8_t& held : held_) held = kNothing; ;"),
        ("for (uint8_t& held : held_) held = kNothing; length_ = 0;",
         "for (uint8_t& held : held_) held = kNothing; length_ = 1;"),
        ("length_ = 0; at_ = 0;",
         "length_ = 0; ;"),
        ("length_ = 0; at_ = 0;",
         "length_ = 0; at_ = 1;"),
    ),
    "a file that is missing is an OSError, which is passed over": (
        ("_path(port).unlink(missing_ok=True)",
         "_path(port).unlink(missing_ok=False)"),
    ),
    "any number but 0 turns it on": (
        ("peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)",
         "peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 2)"),
    ),
    "the next case does nothing, and is the last one": (
        ("value = generation_ ^ kMarkOf; break;",
         "value = generation_ ^ kMarkOf; ;"),
        ("case WriteStep::kEmpty: break;",
         "case WriteStep::kEmpty: ;"),
    ),
    "only that of a DEF is looked at, and a DEF begins with 0": (
        ("self.deepest = 0  # blocks open at once in the routine that is being checked",
         "self.deepest = 1  # blocks open at once in the routine that is being checked"),
    ),
    "both have the same length: another number of arguments was reported before": (
        ("for each, its in zip(arguments[forever:], word.arguments[forever:], strict=True)",
         "for each, its in zip(arguments[forever:], word.arguments[forever:], strict=False)"),
    ),
    "a row of a HEX file has five bytes at least": (
        ("const [count = 0, high = 0, low = 0, kind = 0] = found;",
         "const [count = 0, high = 0, low = 0, kind = 1] = found;"),
    ),
    "a board answers at once, or not at all": (
        ("const ANSWER_MS = 1000;",
         "const ANSWER_MS = 1001;"),
        ("if (left <= 0) break;",
         "if (left <= 1) break;"),
    ),
    "whoever cannot write hears that the cable has gone, too, and whoever hears it cannot write": (
        ("() => { this.#isGone = true;",
         "() => { ;"),
        ("} catch { this.#isGone = true;",
         "} catch { ;"),
    ),
}
# fmt: on

EQUIVALENT = {pair for pairs in _REASONS.values() for pair in pairs}
