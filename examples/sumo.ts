// robot: sumo
// Looks around for the rival, drives at it, and turns back at the white edge.
// tsc upload examples/sumo.ts --virtual --world sumo
SI|LOOP(FOREVER);
  IF(LINE_L OR LINE_R);
    B(0.4, 60);
    R(0.3, 60);
  ELSEIF(DISTANCE < 90);
    M(100, 100);
  ELSE;
    M(30, -30);
  ENDIF;
  W(0.01);
END_LOOP;
