// robot: grabber
// Blinks while it drives: the TASK has its own time.
// tsc upload examples/blink.ts --virtual
SI|LOOP(FOREVER);
  F(2, 60);
  R(0.6, 60);
END_LOOP;
TASK;
  LOOP(FOREVER);
    LED(TRUE);
    W(0.5);
    LED(FALSE);
    W(0.5);
  END_LOOP;
END_TASK;
