// Follows a light: drives on, and a WHEN for each side turns the robot while that side is brighter.
// tsc upload examples/light_when.ts --virtual --world light
SI|F(FOREVER, 60);
WHEN(LIGHT_L > LIGHT_R + 20);
  M(20, 60);
END_WHEN;
WHEN(LIGHT_R > LIGHT_L + 20);
  M(60, 20);
END_WHEN;
