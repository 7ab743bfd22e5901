// Drives as the remote control says; A sounds the horn.
// tsc run examples/remote.ts --max-time 1 --sensor PAD_Y=60
SI|LOOP(FOREVER);
  M(PAD_Y + PAD_X, PAD_Y - PAD_X);
  W(0.05);
END_LOOP;
WHEN(KEY_A);
  BEEP(0.2, 440);
END_WHEN;
