"""Builds a program for this computer with its own compiler."""

import sys

from SCons.Script import Default, DefaultEnvironment

print("Offline stand-in for PlatformIO's platform native: this computer's g++", file=sys.stderr)

env = DefaultEnvironment()
env.Replace(CC="gcc", CXX="g++", AR="ar", RANLIB="ranlib", LINK="$CXX", SIZETOOL="size")
Default([env.BuildProgram()])
