// The paper's obstacle program: forward until something is within 10 cm,
// then stop, turn right and go on. tsc warns: it looks once a second; obstacle_until.ts looks 50 times.
SI|START;
LOOP(FOREVER);
  F(1, 80);
  DISTANCE;
  IF(DISTANCE < 10);
    STOP;
    R(1, 60);
  ENDIF;
END_LOOP;
