"""The functions of a sketch that move, wait and sound, for every kit.

Each is text whose `$words` are names that `names` has: a function mentioned in another's text is
written, too. `$N` is the type of numbers. Parameters and own variables are English here; the
catalogue `sketch` has them in each language.
"""

from __future__ import annotations

from collections.abc import Sequence
from string import Template

_POWERS = {
    "forward": "power, power", "backward": "-power, -power",
    "turn_left": "-power, power", "turn_right": "power, -power",
}  # fmt: skip
_STARTS = {
    "start_forward": "forward", "start_backward": "backward",
    "start_left": "turn_left", "start_right": "turn_right",
}  # fmt: skip

_MOVE = Template("""\
void $$$name($$N seconds, int power) {
  $$motors($powers);
  $$wait_ms($$to_ms(seconds));
  $$stop_motors();
}""")
_START = Template("""\
void $$$name($$N seconds, int power) {
  $$start_move(seconds, $powers);
  $$move_drives = true;
}""")

HELPERS: dict[str, str] = {
    **{name: _MOVE.substitute(name=name, powers=_POWERS[name]) for name in _POWERS},
    **{name: _START.substitute(name=name, powers=_POWERS[move]) for name, move in _STARTS.items()},
    "stop_motors": "void $stop_motors() { $motors(0, 0); }",
    "wait": "void $wait($N seconds) { $wait_ms($to_ms(seconds)); }",
    "start_wait": """\
void $start_wait($N seconds) {
  $start_move(seconds, 0, 0);
  $move_drives = false;
}""",
    "start_move": """\
void $start_move($N seconds, int left, int right) {
  if (millis() - $due > 20) $due = millis();
  $move_start = $due;
  $move_ms = $is_forever ? 0xFFFFFFFF : $to_ms(seconds);
  $move_left = left;
  $move_right = right;
  $move_runs = 0;
}""",
    "move_lasts": """\
bool $move_lasts() {
  if ($move_runs == 0) {
    $move_runs = 1;
    return true;
  }
  if ($move_runs == 1 && $move_drives) $motors($move_left, $move_right);
  $move_runs = 2;
  unsigned long next = ((millis() - $move_start) / 20 + 1) * 20;
  if (next > $move_ms) next = $move_ms;
  while (millis() - $move_start < next) $check_button();
  $due = $move_start + next;
  return next < $move_ms;
}""",
    "end_move": """\
void $end_move() {
  if ($move_runs == 2 && $move_drives) $stop_motors();
}""",
    "wait_ms": """\
void $wait_ms(unsigned long ms) {
  if (millis() - $due > 20) $due = millis();
  $due += ms;
  while ((long)(millis() - $due) < 0) $check_button();
}""",
    "beep": """\
void $beep($N seconds, unsigned int hertz) {
  unsigned long ms = $to_ms(seconds);
  if (ms > 0) tone($BUZZER_PIN, hertz);
  $wait_ms(ms);
  noTone($BUZZER_PIN);
}""",
    "check_button": """\
void $check_button() {
  if (digitalRead($START_BUTTON_PIN) == HIGH) {
    $was_up = true;
  } else if ($was_up) {
    $halt();
  }
}""",
    "wait_for_button": """\
void $wait_for_button() {
  do {
    while (digitalRead($START_BUTTON_PIN) == HIGH) {
    }
    delay(30);
  } while (digitalRead($START_BUTTON_PIN) == HIGH);
  while (digitalRead($START_BUTTON_PIN) == LOW) {
  }
  delay(30);
  $was_up = false;
  $started = $due = millis();
}""",
    "finish": """\
void $finish() {
  $stop_motors();
  tone($BUZZER_PIN, 1047);
  delay(120);
  tone($BUZZER_PIN, 1568);
  delay(120);
  noTone($BUZZER_PIN);
}""",
    "show_yes_no": """\
void $show_yes_no(bool value) { Serial.println(value ? "TRUE" : "FALSE"); }""",
    "ping_ms": """\
unsigned int $ping_ms(int triggerPin, int echoPin) {
  while (millis() - $last_ping < 30) {
  }
  $last_ping = millis();
  digitalWrite(triggerPin, HIGH);
  delayMicroseconds(10);
  digitalWrite(triggerPin, LOW);
  unsigned long echo = pulseInLong(echoPin, HIGH, 25000);
  return echo == 0 ? 25000 : echo;
}""",
    "part_of": """\
int $part_of(long value, long low, long high, long first, long last) {
  long way = last > first ? last - first : first - last;
  long part = ((long long)(value - low) * way + (high - low) / 2) / (high - low);
  return last > first ? first + part : first - part;
}""",
}

TO_MS = {
    True: """\
unsigned long $to_ms($N seconds) {
  return seconds.$thousandths < 0 ? 0 : seconds.$thousandths;
}""",
    False: "unsigned long $to_ms($N seconds) { return seconds * 1000 + 0.5; }",
}
IS_FOREVER = {True: "seconds.$thousandths == $FOREVER.$thousandths", False: "seconds == $FOREVER"}
FOREVER = {
    True: "const $N $FOREVER = $exactly(-2147483647L - 1);",
    False: "const float $FOREVER = -1;",
}

# Variables that functions share: the key of a comment, and the code before it.
SHARED_VARIABLES: dict[str, tuple[str, str]] = {
    "due": ("shared_start", "unsigned long $started, $due;"),
    "random_state": ("shared_random", "unsigned long $random_state = 1;"),
    "was_up": ("", "bool $was_up = false;"),
    "last_ping": ("", "unsigned long $last_ping = -30;"),
    "move_runs": (
        "shared_move",
        "unsigned long $move_start, $move_ms;\nint $move_left, $move_right;\n"
        "bool $move_drives;\nbyte $move_runs;",
    ),
}

SERVO_PULSE = """\
void $servo_pulse(byte servo, unsigned int us, byte pulses) {
  noInterrupts();
  $pulse_us[servo] = us;
  $pulses_left[servo] = pulses;
  interrupts();
}"""
BEGIN_SERVOS = """\
void $begin_servos() {
  for (byte servo = 0; servo < $SERVOS; servo++) pinMode($SERVO_PINS[servo], OUTPUT);
  TCCR1A = 0;
  TCCR1B = 1 << WGM12 | 1 << CS11;
  OCR1A = 40000;
  TIMSK1 = 1 << OCIE1A;
}

ISR(TIMER1_COMPA_vect) {
  static byte turn = $SERVOS;
  static unsigned int used = 0;
  if (turn < $SERVOS) {
    digitalWrite($SERVO_PINS[turn], LOW);
    turn++;
  } else {
    turn = 0;
    used = 0;
  }
  while (turn < $SERVOS && $pulse_us[turn] == 0) turn++;
  if (turn == $SERVOS) {
    OCR1A = 40000 - used;
    return;
  }
  digitalWrite($SERVO_PINS[turn], HIGH);
  OCR1A = 2 * $pulse_us[turn];
  used += OCR1A;
  if ($pulses_left[turn] > 0 && --$pulses_left[turn] == 0) $pulse_us[turn] = 0;
}"""


def shared_servo_code(pins: Sequence[str]) -> str:
    return (
        f"const byte $SERVOS = {len(pins)};\n"
        f"const byte $SERVO_PINS[$SERVOS] = {{{', '.join(pins)}}};\n"
        "volatile unsigned int $pulse_us[$SERVOS];\nvolatile byte $pulses_left[$SERVOS];"
    )
