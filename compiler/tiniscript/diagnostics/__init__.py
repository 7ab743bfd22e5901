"""What is said of a program: codes, places, and the words for them in two languages."""
