// Drives towards the light: the motor on the darker side turns faster.
SI|LOOP(FOREVER);
  DIFFERENCE = (LIGHT_R - LIGHT_L) / 10;
  M(50 + DIFFERENCE, 50 - DIFFERENCE);
  W(0.05);
END_LOOP;
