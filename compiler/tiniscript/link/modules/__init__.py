"""Bluetooth modules on a wire: identifies a module, and sets its name, PIN and speed."""
