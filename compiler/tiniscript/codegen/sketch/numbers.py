"""The functions of a sketch that calculate: exactly as TiniScript does, in thousandths.

Each is text whose `$words` are names that `names` has. One that another needs is named there,
and `operator +` by `@ADD`.
"""

from __future__ import annotations

from tiniscript.codegen.sketch.expressions import ARITHMETIC_OPS, COMPARISON_OPS, SIGNS

STRUCT = """\
struct $Number {
  long $thousandths;
  $Number() : $thousandths(0) {}
  $Number(int value) : $thousandths(value * 1000L) {}
  $Number(long value) : $thousandths(value * 1000) {}
  $Number(double value) : $thousandths(value < 0 ? value * 1000 - 0.5 : value * 1000 + 0.5) {}
};
"""

_RESULTS = {
    "ADD": "return $in_range((long long)a.$thousandths + b.$thousandths);",
    "SUB": "return $in_range((long long)a.$thousandths - b.$thousandths);",
    "MUL": "return $divided((long long)a.$thousandths * b.$thousandths, 1000);",
    "DIV": """\
if (b.$thousandths == 0) return $fault("DIVIDE_BY_ZERO");
  return $divided(a.$thousandths * 1000LL, b.$thousandths);""",
    "MOD": """\
if (b.$thousandths == 0) return $fault("DIVIDE_BY_ZERO");
  long long rest = (long long)a.$thousandths % b.$thousandths;
  if (rest != 0 && (rest < 0) != (b.$thousandths < 0)) rest += b.$thousandths;
  return $in_range(rest);""",
}


def _operator(op: str) -> str:
    sign = SIGNS[op]
    if op in ARITHMETIC_OPS:
        return f"$Number operator{sign}($Number a, $Number b) {{\n  {_RESULTS[op]}\n}}"
    comparison_code = f"a.$thousandths {sign} b.$thousandths"
    return f"bool operator{sign}($Number a, $Number b) {{ return {comparison_code}; }}"


NUMBERS: dict[str, str] = {
    **{op: _operator(op) for op in (*_RESULTS, *sorted(COMPARISON_OPS))},
    "NEG": "$Number operator-($Number a) {\n  return $in_range(-(long long)a.$thousandths);\n}",
    "exactly": """\
$Number $exactly(long $thousandths) {
  $Number made;
  made.$thousandths = $thousandths;
  return made;
}""",
    "in_range": """\
$Number $in_range(long long result) {
  if (result < -2147483648LL || result > 2147483647LL) return $fault("OVERFLOW");
  return $exactly(result);
}""",
    "divided": """\
$Number $divided(long long value, long by) {
  bool isNegative = (value < 0) != (by < 0);
  unsigned long long size = value < 0 ? -value : value;
  unsigned long bySize = by < 0 ? -(unsigned long)by : by;
  long long result = (size + bySize / 2) / bySize;
  return $in_range(isNegative ? -result : result);
}""",
    "whole": """\
long $whole($Number value) {
  long units = value.$thousandths / 1000;
  long rest = value.$thousandths % 1000;
  if (rest >= 500) return units + 1;
  if (rest <= -500) return units - 1;
  return units;
}""",
    "limited": """\
long $limited($Number value, long low, long high) {
  long number = $whole(value);
  if (number < low) return low;
  if (number > high) return high;
  return number;
}""",
    "absolute": """\
$Number $absolute($Number a) {
  long long value = a.$thousandths;
  return $in_range(value < 0 ? -value : value);
}""",
    "smaller": """\
$Number $smaller($Number a, $Number b) {
  return b.$thousandths < a.$thousandths ? b : a;
}""",
    "larger": """\
$Number $larger($Number a, $Number b) {
  return b.$thousandths > a.$thousandths ? b : a;
}""",
    "rounded": """\
$Number $rounded($Number a, $Number decimals) {
  long places = $whole(decimals);
  if (places >= 3) return a;
  if (places < -6) return 0;
  long unit = 1;
  for (; places < 3; places++) unit *= 10;
  long long half = a.$thousandths < 0 ? -(unit / 2) : unit / 2;
  return $in_range((a.$thousandths + half) / unit * unit);
}""",
    "random": """\
$Number $random($Number low, $Number high) {
  long first = $whole(low);
  long last = $whole(high);
  if (first > last) {
    long other = first;
    first = last;
    last = other;
  }
  $random_state ^= $random_state << 13;
  $random_state ^= $random_state >> 17;
  $random_state ^= $random_state << 5;
  unsigned long count = (unsigned long)last - first + 1;
  return $in_range((first + (long long)($random_state % count)) * 1000);
}""",
    "fault": """\
$Number $fault(const char *name) {
  $stop_motors();
  Serial.print("FAULT ");
  Serial.println(name);
  $halt();
  return 0;
}""",
    "show_number": """\
void $show_number($Number value) {
  unsigned long size = value.$thousandths;
  if (value.$thousandths < 0) {
    Serial.print('-');
    size = -size;
  }
  Serial.print(size / 1000);
  int rest = size % 1000;
  if (rest > 0) {
    Serial.print('.');
    if (rest < 100) Serial.print('0');
    if (rest < 10) Serial.print('0');
    while (rest % 10 == 0) rest /= 10;
    Serial.print(rest);
  }
  Serial.println();
}""",
    "time": """\
$Number $time() {
  unsigned long late = millis() - $due;
  return $exactly(late < 5 ? $due - $started : $due + late - $started);
}""",
}
