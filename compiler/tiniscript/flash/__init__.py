"""Puts the firmware onto a board: prebuilt files, bootloaders, and the program that writes it."""
