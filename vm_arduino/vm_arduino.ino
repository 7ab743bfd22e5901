// The sketch is in src/main.cpp. The Arduino IDE wants a file with the name of the folder.
