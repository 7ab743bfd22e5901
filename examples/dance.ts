// A dance of two steps, three times. Starts with the button.
SB|DEF STEP_LEFT;
  L(0.3, 60);
  BEEP(0.1, 440);
END_DEF;

DEF STEP_RIGHT;
  R(0.3, 60);
  BEEP(0.1, 660);
END_DEF;

LOOP(3);
  STEP_LEFT;
  STEP_RIGHT;
END_LOOP;
