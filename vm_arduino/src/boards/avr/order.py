"""Has the linker place functions as `order.ld` says; `platformio.ini` names this file.

It compiles the whole sketch as one piece: in parts, as it does by default, it finds 6 bytes less.
"""

Import("env")  # noqa: F821 - of PlatformIO

SCRIPT = env.subst("$PROJECT_DIR/src/boards/avr/order.ld")  # noqa: F821
env.Append(LINKFLAGS=["-ffunction-sections", "-flto-partition=none", f"-Wl,-T,{SCRIPT}"])  # noqa: F821
env.Depends("$BUILD_DIR/${PROGNAME}.elf", SCRIPT)  # noqa: F821
