"""What others take for the same, measured once with their own tools; on an AVR where it says so.

Rows of the tables that the commands beside this file print: a name, and a figure for each column.
"""

# Cycles of one iteration of the works A, B and C (`workloads`) on an ATmega328P.
CYCLES = (
    ("C, compiled, variables in RAM, int32", "32", "47.5", "1,380"),
    ("C, compiled, float", "155", "260", "1,039"),
    ("C, compiled, thousandths with int64", "32", "47.5", "3,031"),
    ("FlashForth 5, compiles on the chip, int16", "125", "205", "1,294"),
    ("wasm3 0.5.0, on an ATmega1284P, int32", "459", "737", "2,454"),
    ("Aseba, int16", "2,234", "3,323", "5,330"),
    ("Snek 1.9, float", "2,877", "4,815", "9,598"),
    ("NanoVM 1.5 (Java), int31", "2,964", "4,552", "8,926"),
    ("Microvium 8 (JavaScript), int32", "3,843", "3,956", "7,085"),
    ("uLisp 4.8g, on an ATmega2560, int16", "3,451", "7,751", "17,232"),
    ("TinyBASIC Plus 0.15, int16", "5,513", "9,571", "20,084"),
    ("Bitlash 2.0, int32", "8,270", "13,361", "17,418"),
    ("uBASIC, int16", "8,893", "15,836", "27,855"),
)

# Bytes of flash, and of RAM before anything runs, on an AVR.
SIZES = (
    ("Aseba, machine, no functions", "2,584", "300"),
    ("uBASIC, core", "3,040", "158"),
    ("NanoVM 1.5, whole program", "7,712", "1,073"),
    ("TinyBASIC Plus 0.15, whole program", "8,132", "1,375"),
    ("FlashForth 5, whole program", "8,470", "-"),
    ("Bitlash 2.0, whole program", "15,950", "996"),
    ("Microvium 8, machine, no float", "18,433", "684"),
    ("Snek 1.9, whole program", "32,204", "2,048"),
    ("uLisp 4.8g, whole program, ATmega2560", "68,268", "6,147"),
    ("wasm3 0.5.0, whole program, ATmega1284P", "82,266", "6,250"),
)

# Bytes of the three programs that `compiler` measures.
CODE = (
    ("TiniScript text", "10", "27", "87"),
    ("MicroPython .mpy (mpy-cross 1.29 -O3)", "32", "49", "71"),
    ("Microvium 8 snapshot", "74", "94", "130"),
    ("WebAssembly (zig cc -Os, stripped)", "86", "103", "140"),
    ("Aseba bytecode", "22", "44", "58"),
    ("AVR machine code, function only, int16", "12", "36", "38"),
)

# From the last character of a typed line to a pin, in ms, at any baud.
TYPED = (
    ("Snek 1.9", "2.5", "2.5"),
    ("FlashForth 5", "6.9", "6.9"),
    ("Bitlash 2.0", "0.6", "0.6"),
)

# From the start of a command to the first motion.
FIRST_MOTION = (
    ("Arduino: compile and upload, warm", "2200 ms"),
    ("the same, cold", "3100 ms"),
    ("mpremote run, the computer's half", "50 ms"),
    ("opening an Uno's port, which resets it", "1400 ms"),
)
