"""Adds the Arduino core of Debian to a build."""

from pathlib import Path

from SCons.Script import DefaultEnvironment

env = DefaultEnvironment()
board = env.BoardConfig()
home = Path(env.PioPlatform().get_package_dir("framework-arduino-avr"))
core = str(home / "cores" / board.get("build.core"))
variant = str(home / "variants" / board.get("build.variant"))

env.Append(
    CPPDEFINES=[
        ("ARDUINO", 10808),
        "ARDUINO_ARCH_AVR",
        # The core needs definitions that avr-gcc 5.4 omits from float.h in C++.
        ("DECIMAL_DIG", "__DECIMAL_DIG__"),
    ],
    CPPPATH=[core, variant],
    LIBSOURCE_DIRS=[str(home / "libraries")],
)
env.BuildSources("$BUILD_DIR/Variant", variant)
env.Append(LIBS=[env.BuildLibrary("$BUILD_DIR/Core", core)])
