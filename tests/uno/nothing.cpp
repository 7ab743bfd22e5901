// Does nothing, as a board that waits for its first sketch.

int main() {
  for (;;) {
  }
}
