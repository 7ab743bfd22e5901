"""The version of TiniScript: of the package, the command and the Arduino library."""

__version__ = "0.3.0"
