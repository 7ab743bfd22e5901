// The programs behind the pictures of the start screen: each moves the robot at once.

/** What is in the editor of who has never been here. */
export const FIRST_PROGRAM = 'SI|F(2, 80);\nR(0.5, 60);\nF(1, 80);\n';

/** @typedef {{robot: string, world: string, text: string}} Beginning */

/** @type {Record<string, Beginning>} by the names of the pictures */
export const BEGINNINGS = {
  dance: { robot: 'tinibot', world: 'dance', text: `\
SI|LOOP(3);
  R(0.4, 70);
  BEEP(0.15, 440);
  L(0.8, 70);
  BEEP(0.15, 660);
  R(0.4, 70);
END_LOOP;
` },
  square: { robot: 'tinibot', world: 'free', text: `\
SI|LOOP(4);
  F(0.8, 70);
  L(0.42, 60);
END_LOOP;
` },
  obstacle: { robot: 'tinibot', world: 'obstacles', text: `\
SI|LOOP(FOREVER);
  F(FOREVER, 70) UNTIL(DISTANCE < 20);
  BEEP(0.1, 880);
  B(0.5, 60);
  R(1, 60);
END_LOOP;
` },
  line: { robot: 'liner', world: 'line', text: `\
SI|LOOP(FOREVER);
  IF(LINE_L);
    M(10, 60);
  ELSEIF(LINE_R);
    M(60, 10);
  ELSE;
    M(50, 50);
  ENDIF;
  W(0.02);
END_LOOP;
` },
  light: { robot: 'tinibot', world: 'light', text: `\
SI|LOOP(FOREVER);
  IF(LIGHT_L > LIGHT_R);
    M(30, 60);
  ELSE;
    M(60, 30);
  ENDIF;
  W(0.05);
END_LOOP;
` },
  music: { robot: 'tinibot', world: 'dance', text: `\
SI|M(20, 40);
LOOP(2);
  BEEP(0.6, 659);
  BEEP(0.3, 698);
  BEEP(0.6, 784);
  BEEP(0.3, 698);
  BEEP(0.3, 659);
  BEEP(0.3, 587);
  BEEP(0.6, 523);
END_LOOP;
S;
` },
  drive: { robot: 'tinibot', world: 'free', text: `\
SI|LOOP(FOREVER);
  M(PAD_Y + PAD_X, PAD_Y - PAD_X);
  W(0.05);
END_LOOP;
WHEN(KEY_A);
  BEEP(0.2, 440);
END_WHEN;
` },
};

/** Whether a program is one that the page has brought. @param {string} text */
export function isShippedProgram(text) {
  return text === FIRST_PROGRAM || Object.values(BEGINNINGS).some((beginning) => beginning.text === text);
}
