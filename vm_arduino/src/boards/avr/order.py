"""Makes the linker place functions and tables in the order of `order.ld`; `platformio.ini` names
this file.

The C library's start is replaced by `vectors.S`. The sketch is compiled as one piece: in parts, as
is usual, the compiler finds 6 bytes less.
"""

Import("env")  # noqa: F821 - of PlatformIO

SCRIPT = env.subst("$PROJECT_DIR/src/boards/avr/order.ld")  # noqa: F821
env.Append(  # noqa: F821
    LINKFLAGS=[
        "-nostartfiles",
        "-ffunction-sections",
        "-fdata-sections",
        "-flto-partition=none",
        f"-Wl,-T,{SCRIPT}",
    ]
)
env.Depends("$BUILD_DIR/${PROGNAME}.elf", SCRIPT)  # noqa: F821
