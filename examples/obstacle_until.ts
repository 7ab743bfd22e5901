// The same, but the robot looks 50 times a second while it drives.
SI|LOOP(FOREVER);
  F(FOREVER, 80) UNTIL(DISTANCE < 10);
  BEEP(0.1, 880);
  R(0.5, 60);
END_LOOP;
