// Drives on, and backs away from whatever comes near: the WHEN takes the motors, and gives them back.
// tsc upload examples/away.ts --virtual
SI|F(FOREVER, 60);
WHEN(DISTANCE < 15);
  B(0.5, 60);
  R(0.5, 60);
END_WHEN;
