"""The lexicon of English: what a word may mean. Its columns are those of `lexicon_es`."""

TABLE = """
# meaning       | words
# commands, blocks and values
F               | FORWARD FWD FD AHEAD GO MOVE WALK STRAIGHT KEEP DRIVE
B               | BACKWARD BACKWARDS BACK BK REVERSE BACK_UP
L               | LEFT LT TURN_LEFT
R               | RIGHT RT TURN_RIGHT
S               | HALT FREEZE BRAKE
W               | WAIT DELAY SLEEP PAUSE
M               | MOTOR MOTORS
BEEP            | TONE BUZZ BUZZER SOUND MUSIC NOTE
SHOW            | PRINT PRINTLN PRINTF WRITE SAY DISPLAY ECHO LOG
START           | BEGIN VOID_SETUP
ELSEIF          | ELIF ELSIF
ELSE            | OTHERWISE
ENDIF           | FI IF_END
LOOP            | REPEAT FOR DO TIMES
END_LOOP        | END_REPEAT ENDREPEAT END_FOR ENDFOR LOOP_END NEXT END_FOREVER ENDFOREVER
END_WHILE       | WHILE_END WEND
WHEN            | WHENEVER EVERY_TIME EVERYTIME
END_WHEN        | END_WHENEVER WHEN_END
TASK            | THREAD
END_TASK        | END_THREAD TASK_END
FOREVER         | VOID_LOOP
BREAK           | EXIT LEAVE
DEF             | DEFINE FUNCTION PROCEDURE SUB VOID
END_DEF         | END_FUNCTION DEF_END END_SUB
TRUE            | YES
RANDOM          | RAND RANDINT
TIME            | MILLIS TIMER
DISTANCE        | ULTRASONIC
GRIPPER         | CLAW CLAWS JAW JAWS
LED             | LAMP BULB
BATTERY         | BATTERIES
TEMPERATURE     | THERMOMETER
LINE_L          | LINE_LEFT
LINE_R          | LINE_RIGHT
LIGHT_R         | LIGHT_RIGHT
LIGHT_L         | LIGHT_LEFT
# what an actuator of a kit is set to
lit             | ON LIT
dark            | OFF
most            | OPEN OPENED
least           | CLOSE CLOSED SHUT
# which way: the word behind says it
turn            | ROTATE SPIN TURN
# numbers in words
number 1        | ONE
number 2        | TWO
number 3        | THREE
number 4        | FOUR
number 5        | FIVE
number 6        | SIX
number 7        | SEVEN
number 8        | EIGHT
number 9        | NINE
number 10       | TEN
number 11       | ELEVEN
number 12       | TWELVE
number 15       | FIFTEEN
number 20       | TWENTY
number 30       | THIRTY
number 40       | FORTY
number 50       | FIFTY
number 60       | SIXTY
number 70       | SEVENTY
number 80       | EIGHTY
number 90       | NINETY
number 100      | HUNDRED
power 100       | MAX FULL HIGH FAST
power 80        | NORMAL
power 50        | HALF MEDIUM
power 40        | SLOW SLOWLY
# units: which one, and how many thousandths of it
unit s 1000     | S SEC SECS SECOND SECONDS
unit s 1        | MS MILLISECOND MILLISECONDS
unit s 60000    | MIN MINS MINUTE MINUTES
unit s 3600000  | H HOUR HOURS
unit cm 1000    | CM CMS CENTIMETER CENTIMETERS
unit cm 30480   | FT FEET FOOT
unit cm 2540    | INCH INCHES
unit cm 100     | MM
unit cm 100000  | M MT MTS METER METERS
unit Hz 1000    | HZ HERTZ
unit ° 1000     | DEG DEGREE DEGREES ° º
unit % 1000     | PERCENT POWER %
unit steps 1000 | STEP STEPS
unit times 1000 | TIMES
unit V 1000     | V
unit °C 1000    | °C
# what a value is called before its number
value %         | POWER SPEED
value s         | TIME SECONDS
value Hz        | HZ
value left      | LEFT
value right     | RIGHT
# what a question in words asks
little          | LITTLE LOW SMALL SHORT LESS SMALLER CLOSE DARK BLACK LINE
much            | MUCH HIGH BIG LARGE LONG MORE BIGGER FAR STRONG FREE CLEAR BRIGHT LOT WHITE PATH WAY
light           | LIGHT LIGHTS DARK BRIGHT LINE BLACK WHITE FLOOR
ahead           | DISTANCE CLOSE FAR SOMETHING PATH WAY FREE CLEAR TOUCH TOUCHES BOX HAND OBSTACLE WALL OBJECT NEAR BLOCKED
none            | NOTHING NOBODY
without         | WITHOUT
half            | HALF
left            | LEFT
right           | RIGHT
# what stands beside a command and changes nothing
filler          | AND AT CAR DRIVES FOR GO GOES HELLO I IN IR MOVES MUST MY OF PLEASE ROBOT SECOND SHOULD THE TO WANT WILL WITH
# other words of a sentence
then            | AND THEN
soon            | AND THEN ALSO
first           | THEN FIRST NEXT FINALLY
do              | THEN DO
make            | DO
times           | TIMES
the             | THE
is              | IS BE
than            | THAN TO FROM
to              | TO IN
less            | LESS SMALLER LOWER CLOSER BELOW UNDER
more            | GREATER BIGGER MORE HIGHER LARGER ABOVE OVER FARTHER
extra           | MORE
equal           | EQUAL EQUALS
different       | DIFFERENT
between         | BETWEEN
modulo          | MOD
during          | FOR
seconds         | S SEC SECS SECOND SECONDS
please          | PLEASE
unless          | UNLESS
milliseconds    | DELAY
until           | UNTIL
when            | WHEN IF
call            | CALL RUN
read            | READ
set             | SET LET
declare         | LET VAR INT FLOAT CONST GLOBAL DIM BOOL BYTE LONG DOUBLE UNSIGNED
keep            | STORE SAVE
beside          | WITH WHILE
idle            | SECONDS THE CAR PLEASE
act             | RETURN DANCE GRAB AVOID DODGE
small           | FOR DO NEXT
often 2         | TWICE
often 3         | THRICE
pace            | FASTER SLOWER
end             | END DONE
program         | PROGRAM
count           | FOR
each            | EACH
jump            | GOTO GOSUB JUMP
pins            | DIGITALWRITE ANALOGWRITE PINMODE DIGITALREAD ANALOGREAD PIN
on              | TURN_ON SWITCH_ON
off             | TURN_OFF SWITCH_OFF
over            | OVER
same            | DITTO SAME AGAIN ONCE
above           | ABOVE BEFORE THING MORE
again           | CONTINUE
every           | EVERY
range           | RANGE
import          | IMPORT FROM INCLUDE USING REQUIRE
wall            | WALL OBSTACLE OBSTACLES
engine          | MOTORS
leave           | STOP S
no              | NOT
"""
