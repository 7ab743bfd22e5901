"""Bluetooth modules on a wire: finds out which one it is, and sets its name, PIN and speed."""
