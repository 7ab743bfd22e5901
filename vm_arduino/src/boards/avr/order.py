"""Has the linker place functions as `order.ld` says; `platformio.ini` names this file."""

Import("env")  # noqa: F821 - of PlatformIO

SCRIPT = env.subst("$PROJECT_DIR/src/boards/avr/order.ld")  # noqa: F821
env.Append(LINKFLAGS=["-ffunction-sections", f"-Wl,-T,{SCRIPT}"])  # noqa: F821
env.Depends("$BUILD_DIR/${PROGNAME}.elf", SCRIPT)  # noqa: F821
