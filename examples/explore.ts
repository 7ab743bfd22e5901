// As away.ts, and never stuck: its eye looks ahead, so every two seconds it frees itself from what may
// stand beside it.  tsc upload examples/explore.ts --virtual
SI|LOOP(FOREVER);
  F(2, 60);
  B(0.4, 60);
  L(0.2, 60);
END_LOOP;
WHEN(DISTANCE < 15);
  B(0.5, 60);
  R(0.5, 60);
END_WHEN;
