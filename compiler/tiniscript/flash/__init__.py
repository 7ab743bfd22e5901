"""The firmware's way onto a board: ready files, bootloaders, and the program that writes."""
