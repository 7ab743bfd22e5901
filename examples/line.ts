// robot: liner
// Follows a black line until the button is pressed.
// tsc upload examples/line.ts --virtual --world line
SI|WHILE(NOT BUTTON);
  IF(LINE_L AND NOT LINE_R);
    M(10, 60);
  ELSEIF(LINE_R AND NOT LINE_L);
    M(60, 10);
  ELSE;
    M(50, 50);
  ENDIF;
  W(0.02);
END_WHILE;
