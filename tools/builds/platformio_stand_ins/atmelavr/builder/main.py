"""Builds firmware.elf and firmware.hex with the avr-gcc of Debian. Does not upload."""

import sys

from SCons.Script import AlwaysBuild, Builder, Default, DefaultEnvironment

print(
    "Offline stand-in for PlatformIO's platform atmelavr: Debian's avr-gcc and Arduino core",
    file=sys.stderr,
)

MACHINE = ["-mmcu=$BOARD_MCU"]
SECTIONS = ["-ffunction-sections", "-fdata-sections", "-flto"]

env = DefaultEnvironment()
env.Replace(
    AR="avr-gcc-ar",
    AS="avr-gcc",
    CC="avr-gcc",
    CXX="avr-g++",
    LINK="$CXX",
    OBJCOPY="avr-objcopy",
    RANLIB="avr-gcc-ranlib",
    SIZETOOL="avr-size",
    SIZECHECKCMD="$SIZETOOL -A -d $SOURCES",
    SIZEPROGREGEXP=r"^(?:\.text|\.data|\.bootloader)\s+(\d+)",
    SIZEDATAREGEXP=r"^(?:\.data|\.bss|\.noinit)\s+(\d+)",
    ARFLAGS=["rcs"],
    PROGNAME="firmware",
    PROGSUFFIX=".elf",
)
env.Append(
    ASFLAGS=[*MACHINE, "-x", "assembler-with-cpp"],
    CCFLAGS=[*MACHINE, "-Os", "-g", *SECTIONS],
    CFLAGS=["-std=gnu11", "-fno-fat-lto-objects"],
    CXXFLAGS=["-std=gnu++11", "-fno-exceptions", "-fno-threadsafe-statics", "-fpermissive"],
    CPPDEFINES=[("F_CPU", "$BOARD_F_CPU")],
    LINKFLAGS=[*MACHINE, "-Os", "-g", "-flto", "-fuse-linker-plugin", "-Wl,--gc-sections"],
    LIBS=["m"],
    BUILDERS={
        "Hex": Builder(
            action=env.VerboseAction("$OBJCOPY -O ihex -R .eeprom $SOURCE $TARGET", "Hex $TARGET"),
            suffix=".hex",
        )
    },
)

elf = env.BuildProgram()
firmware = env.Hex("$BUILD_DIR/${PROGNAME}", elf)
AlwaysBuild(env.Alias("buildprog", firmware, firmware))
Default([elf, firmware])
