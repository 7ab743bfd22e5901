"""Each criterion, by a program that misses it; the same verdict each time; no program holds up."""

from __future__ import annotations

from itertools import permutations
from pathlib import Path

import pytest

from tests.support.lesson_findings import findings_of
from tests.support.texts import LANGUAGES
from tests.support.texts import catalogue_texts as all_said
from tiniscript import robots
from tiniscript.lessons import catalogue, running
from tiniscript.lessons.lesson import Lesson
from tiniscript.lessons.sentences import sentence as words_for
from tiniscript.lessons.variation import point_of, presses_of, vary
from tiniscript.library.compiling import compile_source, image_of

HEAD = 'robot = "{robot}"\nseconds = 10\n{more}\n[title]\nen = "A"\nes = "B"\n'
WORLD = """\
[floor]
width_cm = 300
height_cm = 200
[start]
x_cm = 100
y_cm = 100
heading = 0
[[boxes]]
x_cm = 200
y_cm = 100
length_cm = 20
width_cm = 60
[[lines]]
points = [[20, 100], [110, 100]]
"""


def lesson_of(folder: Path, criteria: str, robot: str = "tinibot", settings: str = "") -> Lesson:
    text = HEAD.format(robot=robot, more=settings) + criteria
    (folder / "lesson.toml").write_text(text, encoding="utf-8")
    (folder / "world.toml").write_text(WORLD, encoding="utf-8")
    return catalogue.load(folder)


def sentences_on(lesson: Lesson, text: str) -> list[str]:
    return [words_for(finding, "en") for finding in findings_of(text, lesson, range(1, 2))]


CASES = [
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "F(0.5, 89)", "stopped 20 cm before the middle of the goal"),
    ('kind = "ends_in"\nat = [140, 100]\nwithin_cm = 5', "F(1, 89)", "F(1.3, 89)", "went 12 cm past the middle"),
    ('kind = "ends_in"\nat = "start"', "F(1, 50); B(1, 50)", "F(1, 50)", "was 22 cm from the goal"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "R(1, 60)", "only turned on the spot. To go forward, use F"),
    ('kind = "reaches"\nat = [[140, 100], [60, 100]]', "F(1, 89); B(2, 89)", "B(1, 89); F(2, 89)", "before the robot got to the goal 2 of 2"),
    ('kind = "reaches"\nat = [140, 100]\nby_seconds = 2', "F(1, 89)", "F(4, 22)", "took 3.0 s to reach the goal; the limit is 2 s"),
    ('kind = "reaches"\nat = [140, 100]\nby_cm = 50', "F(1, 89)", "B(1, 89); F(2, 89)", "drove 110 cm to the goal; 50 cm is enough"),
    ('kind = "stays_in"\nat = "start"\nwithin_cm = 30', "F(0.5, 50)", "F(1, 89)", "After 0.8 s the robot left the goal"),
    ('kind = "stands_before"\nlow_cm = 20\nhigh_cm = 50', "F(1, 89)", "F(0.5, 50)", "stopped 66 cm from the obstacle; the task asks for 20 to 50 cm"),
    ('kind = "stands_before"\nlow_cm = 20\nhigh_cm = 50', "F(1, 89)", "F(1.6, 89)", "stopped 13 cm from the obstacle"),
    ('kind = "faces"\nheading = 90', "L(0.42, 60)", "L(0.2, 60)", "47 degrees too far to the right"),
    ('kind = "faces"\nheading = 90', "L(0.42, 60)", "L(0.8, 60)", "83 degrees too far to the left"),
    ('kind = "never_touches"', "F(1, 50)", "F(3, 80)", "touched a box after 2.2 s"),
    ('kind = "never_touches"', "F(1, 50)", "B(4, 80)", "touched the edge of the floor after 2.5 s"),
    ('kind = "never_touches"\nat = [140, 100]', "F(4, 80)", "B(4, 80)", "touched the edge of the floor after 2.5 s"),
    ('kind = "reaches"\nat = [140, 100]', "F(1, 89)", "F(0.6, 89)", "The program ended while the goal was still 16 cm away"),
    ('kind = "ends_in"\nat = [140, 100]\nx_cm = [-25, 30]\ny_cm = [-10, 10]', "F(0.72, 89)", "F(0.6, 89)", "stopped 16 cm before the middle"),
    ('kind = "stays_in"\nat = "start"\nx_cm = [-30, 30]\ny_cm = [-30, 30]', "L(0.195,60);F(1,75)", "L(0.195,60);F(1,85)", "left the goal"),
    ('kind = "stands_before"\nat = "boxes[1]"\nlow_cm = 5\nhigh_cm = 90', "F(1, 89)", "L(0.42, 60)", "not in front of the goal"),
    ('kind = "reaches"\nat = "boxes[1]"\nwithin_cm = 50\nwhat = "DISTANCE"', "F(0.7, 89)", "F(0.65, 89)", "The program ended while"),
    ('kind = "reaches"\nat = [[140, 100], [100, 100], [60, 100]]\neither_way = true', "B(1, 89);F(2, 89)", "B(1, 89);F(1, 89)", "the goal 1 of 3"),
    ('kind = "reaches"\nat = [[140, 100], [140, 140]]', "F(1, 89);L(0.42, 60);F(1, 89)", "F(1.3, 89);L(0.42, 60);F(1, 89)", "went 12 cm past the goal 1 before it stopped or turned"),
    ('kind = "reaches"\nat = [140, 100]', "F(1, 89)", "F(20, 5)", "s, the robot was still "),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "M(89, 89)", "Add a wait after M"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "IF(LIGHT_L > LIGHT_R);M(10, 50);ELSE;M(50, 10);ENDIF", "Add a wait after M"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "M(50, 50);W(FOREVER) UNTIL(DISTANCE > 9);S", "Is the condition of UNTIL TRUE from the start? See what the robot reads: SHOW(DISTANCE)"),
    ('kind = "beeps"\nat = [140, 100]', "F(1, 89);BEEP(0.1,440)", "BEEP(0.1,440);F(1, 89)", "beeped 40 cm from the goal; the distance must be 10 cm or less"),
    ('kind = "beeps"\nat = ["start", [140, 100]]', "BEEP(0.1,440);F(1, 89);BEEP(0.1,440)", "BEEP(0.1,440);F(1, 89)", "did not beep at the goal 2: its nearest beep was 40 cm away"),
    ('kind = "beeps"\ntimes = 2\n[[criteria]]\nkind = "needs"\nwords = ["LOOP"]', "LOOP(2);BEEP(0.1,440);END_LOOP", "LOOP(2);F(0.1,50);END_LOOP;BEEP(0.1,440);BEEP(0.1,440)", "just as well if each LOOP runs only once."),
    ('kind = "beeps"\n[[criteria]]\nkind = "needs"\nwords = ["DEF"]', "DEF HOP;BEEP(0.1,440);END_DEF;HOP", "DEF HOP;F(0.1,50);END_DEF;HOP;BEEP(0.1,440)", "just as well without the word HOP"),
    ('kind = "beeps"\n[[criteria]]\nkind = "needs"\nwords = ["LOOP"]', "X=0;LOOP(2);IF(X=1);BEEP(0.1,440);ENDIF;X=X+1;END_LOOP", "BEEP(0.1,440)", "does not use LOOP"),
    ('kind = "uses"\nwords = ["UNTIL"]', "F(1,50) UNTIL(DISTANCE < 9)", "W(1) UNTIL(NOT FALSE)", "UNTIL never changes. Use a sensor in it: UNTIL(DISTANCE < 15)"),
    ('kind = "moves"\nat_most = 1\nahead = true', "LOOP(2);M(50,50);W(0.1);M(-50,50);W(0.1);L(0.1,50);END_LOOP", "M(50,50);W(0.1);F(0.1,50)", "has 2 moves forward or back, but needs only 1"),
    ('kind = "reaches"\nat = [140, 100]', "F(1, 89)", "L(0.1, 60);F(0.5, 89);L(1, 60)", "The closest the robot got to the goal was"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89);LOOP(FOREVER);BEEP(0.1, 440);W(1);END_LOOP", "F(1, 89);LOOP(FOREVER);L(0.1, 60);W(1);END_LOOP", "still moving when time ran out after"),
    ('kind = "drives"\nat_least_cm = 40', "F(1, 89)", "F(0.99, 89)", "drove 39.6 cm; the task asks for at least 40 cm"),
    ('kind = "stands_before"\nlow_cm = 20\nhigh_cm = 36', "F(1.1, 89)", "F(1.02, 89)", "stopped 36.2 cm from the obstacle"),
    ('kind = "order"\nwords = ["moves", "stops", "shows"]', "M(50, 50);W(1);SHOW(1);S", "M(50, 50);SHOW(1);W(1)", "After it stops, the robot should show a value"),
    ('kind = "order"\nwords = ["moves", "stops", "shows"]', "M(50, 50);W(1);SHOW(1)", "M(50, 50);SHOW(1);W(1);S", "After it stops, the robot should show a value"),
    ('kind = "order"\nwords = ["moves", "beeps", "moves"]', "M(50, 50);BEEP(0.1,440);M(-50, -50);W(0.1)", "M(50, 50);BEEP(0.1,440);M(50, 50);W(0.1)", "After it beeps, the robot should move"),
    ('kind = "shows"\nwhat = "TIME"\ntolerance = 0.1', "F(1,50);T = TIME;W(1);SHOW(T)", "F(1,50);T = TIME;F(1,50);SHOW(T)", "showed 1, but it drove for 2 s"),
    ('kind = "drives"\nat_least_cm = 30', "F(1, 89)", "F(0.5, 50);W(20)", "stood still from 0.5 s on. It drove 11 cm"),
    ('kind = "stands_before"\nlow_cm = 20\nhigh_cm = 36', "F(9, 89) UNTIL(DISTANCE < 36)", "F(1, 50) UNTIL(DISTANCE < 36)", "because its time was over, before the condition of its UNTIL"),
    ('kind = "stands_before"\nlow_cm = 20\nhigh_cm = 36', "F(1.1, 89)", "M(50, 50);W(1) UNTIL(DISTANCE < 36);S", "because its time was over, before the condition of its UNTIL"),
    ('kind = "stands_before"\nlow_cm = 20\nhigh_cm = 36', "F(1.1, 89)", "F(1, 50) UNTIL(DISTANCE = 600)", "Make it drive closer"),
    ('kind = "stands_before"\nlow_cm = 20\nhigh_cm = 36', "F(1.1, 89)", "F(5, 50) UNTIL(DISTANCE < 50)", "Make it drive closer"),
    ('kind = "drives"\nat_least_cm = 30', "F(1, 89)", "F(0.5, 50)", "drove 11 cm; the task asks for at least 30 cm"),
    ('kind = "drives"\nat_most_cm = 30', "F(0.5, 50)", "F(1, 89)", "drove 40 cm; the task allows at most 30 cm"),
    ('kind = "pauses"\nat_least_seconds = 1', "F(1,50);W(1);B(1,50)", "F(1,50);W(0.5);B(1,50)", "waited 0.5 s; the task asks for 1 s"),
    ('kind = "ends_in"\nat = "start"', "F(1, 50); B(1, 50)", "F(1, 50); B(0.3, 50)", "change only one thing."),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "F(1, 89) UNTIL(DISTANCE > 9)", "did not move. Is the condition of UNTIL TRUE from the start? See what the robot reads: SHOW(DISTANCE)"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "WHILE(LIGHT_L > 900);F(1, 89);END_WHILE", "condition of WHILE FALSE from the start? See what the robot reads: SHOW(LIGHT_L)"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "R(1, 60); IF(LIGHT_L > 900);F(1, 89);ENDIF", "only turned on the spot. Is the condition of IF FALSE"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "DEF GO;F(1, 89);END_DEF", "defines the word GO but never calls it"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "DEF GO;F(1, 89);END_DEF;DEF NO;B(1, 89);END_DEF;GO;GO;GO", "went 37 cm past"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "W(FOREVER) UNTIL(DISTANCE < 9); F(1, 89)", "did not move. Does the condition of UNTIL ever become TRUE? See what the robot reads: SHOW(DISTANCE)"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "WHILE(LIGHT_L < 900);W(0.1);END_WHILE;F(1, 89)", "Does the condition of WHILE ever become FALSE? See what the robot reads: SHOW(LIGHT_L)"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "LOOP(FOREVER);IF(LIGHT_L > 900);F(1, 89);ENDIF;W(0.1);END_LOOP", "Does the condition of IF ever become TRUE?"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "WHILE(DISTANCE > 9);IF(LIGHT_L > 900);F(1, 89);ENDIF;W(0.1);END_WHILE", "Does the condition of IF ever become TRUE?"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "LOOP(2);IF(LIGHT_L > 900);F(1, 89);ENDIF;END_LOOP", "condition of IF FALSE from the start?"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "IF(DISTANCE > 9);S;ELSE;F(1, 89);ENDIF", "condition of IF TRUE from the start?"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "IF(LIGHT_L > 900);BEEP(0.1,440);ENDIF;F(1, 89) UNTIL(DISTANCE > 9)", "condition of UNTIL TRUE from the start?"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "W(0.5) UNTIL(LIGHT_L > 900);F(1, 89) UNTIL(DISTANCE > 9)", "See what the robot reads: SHOW(DISTANCE)"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "DEF GO;F(1, 89);END_DEF;IF(LIGHT_L > 900);GO;ENDIF", "condition of IF FALSE from the start?"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "R(1, 60);W(FOREVER) UNTIL(LIGHT_L > 900);F(1, 89)", "only turned on the spot. Does the condition of UNTIL ever become TRUE?"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "F(1, 0) UNTIL(DISTANCE < 9)", "Add a move with a time and a power"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "F(0, 89) UNTIL(DISTANCE < 9)", "Add a move with a time and a power"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "DEF GO;F(1, 0);END_DEF;GO;IF(LIGHT_L > 900);S;ENDIF", "Add a move with a time and a power"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "DEF A;BEEP(0.1,440);END_DEF;F(1, 0)", "Add a move with a time and a power"),
    ('kind = "shows"', "SHOW(1)", "DEF A;BEEP(0.1,440);END_DEF;F(1, 60)", "The robot showed nothing"),
    ('kind = "shows"', "SHOW(1)", "DEF A;SHOW(1);END_DEF;F(1, 60)", "defines the word A but never calls it"),
    ('kind = "ends_in"\nat = "start"', "F(1, 50); B(1, 50)", "F(0.5, 89); B(1.5, 89)", "At the end the robot was 40 cm from"),
    ('kind = "ends_in"\nat = "start"\n[[criteria]]\nkind = "reaches"\nat = [140, 100]', "F(1, 89); B(1, 89)", "F(0.6, 89)", "The program ended while the goal was still 16 cm away"),
    ('kind = "ends_in"\nat = "start"\n[[criteria]]\nkind = "reaches"\nat = [140, 100]\nby_seconds = 2', "F(1, 89); B(1, 89)", "W(2);F(1, 89); B(1, 89)", "the limit is 2 s"),
    ('kind = "reaches"\nat = [140, 100]', "F(1, 89)", "F(0.6, 89); B(0.6, 89)", "was 16 cm; the task asks for 10 cm or less. Make it drive further"),
    ('kind = "reaches"\nat = [140, 100]', "F(1, 89)", "L(0.2, 60); F(0.6, 89)", "Look at where it went"),
    ('kind = "reaches"\nat = [140, 100]', "F(1, 89)", "L(0.2, 60)", "only turned on the spot"),
    ('kind = "reaches"\nat = [[140, 100], [60, 100]]', "F(1, 89); B(2, 89)", "F(1, 89)", "ended before the robot got to the goal 2 of 2"),
    ('kind = "reaches"\nat = [[140, 100], [60, 100]]', "F(1, 89); B(2, 89)", "F(1, 89); B(20, 5)", "In 10.0 s the robot did not get to the goal 2 of 2"),
    ('kind = "reaches"\nat = [[140, 100], [60, 100]]', "F(1, 89); B(2, 89)", "LOOP(20);F(1, 89);B(1, 89);END_LOOP", "did not get to the goal 2 of 2. Look at the move that should take it there"),
    ('kind = "faces"\nheading = 90', "L(0.42, 60)", "R(0.42, 60)", "facing the opposite way."),
    ('kind = "order"\nwords = ["moves", "beeps", "moves", "beeps", "moves"]', "LOOP(3);F(0.1, 50);BEEP(0.1,440);END_LOOP", "LOOP(2);F(0.1, 50);BEEP(0.1,440);END_LOOP", "After it beeps 2 times, the robot should move once more"),
    ('kind = "shows"', "SHOW(1)", "IF(DISTANCE < 1);SHOW(1);ENDIF", "has SHOW, but the robot never gets there"),
    ('kind = "beeps"', "BEEP(0.1,440)", "IF(DISTANCE < 1);BEEP(0.1,440);ENDIF", "has BEEP, but the robot never gets there"),
    ('kind = "shows"\n[[criteria]]\nkind = "ends"', "SHOW(1)", "LOOP(FOREVER);W(1);END_LOOP;SHOW(1)", "After 10.0 s the program was still running"),
    ('kind = "reaches"\nat = [[140, 100], [60, 100]]', "F(1, 89); B(2, 89)", "F(1, 89);LOOP(FOREVER);SHOW(1);END_LOOP", "did not get to the goal 2 of 2. Look at the move"),
    ('kind = "pauses"\nat_least_seconds = 1\ntimes = 2', "LOOP(3);F(0.2,50);W(1);END_LOOP", "LOOP(3);F(0.2,50);W(0.5);END_LOOP", "waited 0.5 s; the task asks for 1 s"),
    ('kind = "pauses"\nat_least_seconds = 1\ntimes = 2', "LOOP(3);F(0.2,50);W(1);END_LOOP", "F(1,50);W(1);B(1,50)", "2 waits of 1 s between moves; the robot made 1"),
    ('kind = "pauses"\nat_least_seconds = 1\nat = [140, 100]', "F(1,89);W(1);B(1,89)", "F(1,89);B(1,89);W(1);F(0.1,50)", "waited 1.0 s, but 40 cm from the goal; the distance must be 10 cm or less"),
    ('kind = "pauses"\nat_least_seconds = 1\nat = ["start", [140, 100]]', "F(0.1,50);W(1);F(0.9,89);W(1);B(1,50)", "F(0.1,50);W(1);F(0.9,89);B(1,50)", "did not wait 1 s at the goal 2: its nearest wait was 37 cm away"),
    ('kind = "ends_in"\nat = [140, 100]', "F(1, 89)", "F(1, 89);B(1, 89)", "reached the goal but left it again: at the end it was 40 cm away"),
    ('kind = "uses"\nwords = ["DEF"]', "DEF HOP;BEEP(0.1,440);END_DEF;HOP", "DEF HOP;BEEP(0.1,440);END_DEF", "word HOP but never calls it"),
    ('kind = "uses"\nwords = ["DEF"]', "DEF HOP;BEEP(0.1,440);END_DEF;DEF TWO;HOP;HOP;ENDDEF;TWO", "DEF HOP;BEEP(0.1,440);END_DEF;DEF TWO;HOP;HOP;ENDDEF;W(1)", "word HOP but never calls it"),
    ('kind = "uses"\nwords = ["LOOP"]', "LOOP(2);W(0.1);BEEP(0.1,440);ENDLOOP", "LOOP(2);W(0.1);END_LOOP", "LOOP repeats nothing."),
    ('kind = "uses"\nwords = ["LOOP"]', "DEF HOP;BEEP(0.1,440);END_DEF;LOOP(2);HOP;END_LOOP", "LOOP(1);BEEP(0.1,440);END_LOOP", "LOOP repeats nothing."),
    ('kind = "shows"\nvalue = 4', "SHOW(2 + 2)", "SHOW(5)", "showed 5, but 4 is correct"),
    ('kind = "shows"\nwhat = "DISTANCE"\ntolerance = 1', "SHOW(DISTANCE)", "SHOW(50)", "showed 50, but at that moment DISTANCE was about 77"),
    ('kind = "shows"\nwhat = "TIME"\ntolerance = 0.1', "W(1);SHOW(TIME)", "W(1);SHOW(2)", "showed 2, but it drove for 1 s"),
    ('kind = "shows"\ntimes = 2', "SHOW(1);SHOW(TRUE)", "SHOW(1)", "showed 1 of 2 values"),
    ('kind = "shows"', "SHOW(1)", "W(1)", "showed nothing"),
    ('kind = "beeps"\ntimes = 2', "BEEP(0.1,440);BEEP(0.1,440)", "BEEP(0.1,440)", "beeped 1 of 2 times"),
    ('kind = "beeps"\ntimes = 2\npitches = 2', "BEEP(0.1,440);BEEP(0.1,880)", "BEEP(0.1,440);BEEP(0.1,440)", "1 different pitches instead of 2"),
    ('kind = "beeps"', "BEEP(0.1,440)", "W(1)", "did not beep"),
    ('kind = "order"\nwords = ["beeps", "moves", "stops", "shows"]', "BEEP(0.1,440);F(1,50);SHOW(1)", "F(1,50);BEEP(0.1,440);SHOW(1)", "After it beeps, the robot should move"),
    ('kind = "order"\nwords = ["moves"]', "F(1,50)", "W(1)", "did not move"),
    ('kind = "ends"', "W(1)", "LOOP(FOREVER);W(1);END_LOOP", "After 10.0 s the program was still running"),
    ('kind = "uses"\nwords = ["UNTIL"]', "F(1,50) UNTIL(DISTANCE < 9)", "F(1,50) // UNTIL", "does not use UNTIL"),
    ('kind = "uses"\nwords = ["LOOP"]\ntimes = 2', "LOOP(2);LOOP(2);BEEP(0.1,440);END_LOOP;END_LOOP", "LOOP(2);W(0.1);END_LOOP", "needs 2 uses of LOOP, and the program has 1"),
    ('kind = "moves"\nat_most = 1', "LOOP(2);F(0.1,50);END_LOOP", "F(0.1,50);F(0.1,50)", "has 2 moves, but needs only 1"),
]  # fmt: skip


@pytest.mark.parametrize(("criterion", "right_text", "wrong_text", "sentence"), CASES)
def test_a_criterion_is_met_or_missed(
    tmp_path: Path, criterion: str, right_text: str, wrong_text: str, sentence: str
) -> None:
    lesson = lesson_of(tmp_path, f"[[criteria]]\n{criterion}\n")
    assert sentences_on(lesson, right_text) == []
    (missing,) = findings_of(wrong_text, lesson, range(1, 2))
    texts_of_both, spanish = (words_for(missing, language) for language in ("en", "es"))
    assert sentence in texts_of_both
    assert spanish != texts_of_both
    assert "{" not in texts_of_both + spanish


@pytest.mark.parametrize("count", [2, 3, 5])
def test_a_def_is_used_where_calls_lead_to_it(tmp_path: Path, count: int) -> None:
    """Any number of DEFs may be in between; after a missing call, none counts as used."""
    words = ["HOP", "TURN", "DANCE", "BOX", "SHOWER"][:count]
    lesson = lesson_of(tmp_path, f'[[criteria]]\nkind = "uses"\nwords = ["DEF"]\ntimes = {count}\n')

    def program(cut: str) -> str:
        bodies = [
            f"DEF {word};{callee if callee != cut else 'W(1)'};END_DEF"
            for word, callee in zip(words, ["BEEP(0.1, 440)", *words], strict=False)
        ]
        return ";".join([*bodies, words[-1] if words[-1] != cut else "W(1)"])

    assert sentences_on(lesson, program("")) == []
    for word in words:
        (missing,) = sentences_on(lesson, program(word))
        assert "word HOP but never calls it" in missing


OBEYS_CRITERION = """
[[criteria]]
kind = "obeys"
[[presses]]
at_seconds = 1
seconds = 1
key = "{key}"
"""
ANSWER_BY_KEY = {"UP": "F(0.1, 60)", "DOWN": "B(0.1, 60)", "LEFT": "L(0.1, 60)", "RIGHT": "R(0.1, 60)",
                 "A": "BEEP(0.1, 440)", "B": "BEEP(0.1, 440)"}  # fmt: skip
MISSED_BY_KEY = {"UP": "drive forward", "DOWN": "drive backward", "LEFT": "turn to the left",
                 "RIGHT": "turn to the right", "A": "beep", "B": "beep"}  # fmt: skip
OPPOSITE_KEY = {"UP": "DOWN", "DOWN": "UP", "LEFT": "RIGHT", "RIGHT": "LEFT", "A": "B", "B": "A"}


def answer_to_key(key: str, does: str) -> str:
    return f"LOOP(FOREVER); IF(KEY_{key}); {does}; END_IF; W(0.02); END_LOOP"


@pytest.mark.parametrize("key", ANSWER_BY_KEY)
def test_the_judge_presses_a_key_and_checks_the_reaction(tmp_path: Path, key: str) -> None:
    lesson = lesson_of(tmp_path, OBEYS_CRITERION.format(key=f"KEY_{key}"))
    assert sentences_on(lesson, answer_to_key(key, ANSWER_BY_KEY[key])) == []
    (missed_text,) = sentences_on(lesson, answer_to_key(OPPOSITE_KEY[key], ANSWER_BY_KEY[key]))
    assert (
        f"At 1.0 s KEY_{key} was held down, but the robot did not {MISSED_BY_KEY[key]}."
        in missed_text
    )
    if not MISSED_BY_KEY[key].startswith("beep"):
        (missed_text,) = sentences_on(lesson, answer_to_key(key, ANSWER_BY_KEY[OPPOSITE_KEY[key]]))
        assert f"did not {MISSED_BY_KEY[key]}." in missed_text


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("F(0.5, 60); " + answer_to_key("UP", "F(0.1, 60)"), "0.0"),
        (answer_to_key("UP", "F(3, 60)"), "2.6"),
        (answer_to_key("UP", "M(60, 60)"), "2.6"),
        (answer_to_key("UP", "F(0.1, 60)").replace("END_IF", "ELSE; L(0.1, 60); END_IF"), "0.0"),
    ],
)
def test_an_undriven_robot_stands_still(tmp_path: Path, text: str, seconds: str) -> None:
    lesson = lesson_of(tmp_path, OBEYS_CRITERION.format(key="KEY_UP"))
    (missed_text,) = sentences_on(lesson, text)
    assert (
        f"At {seconds} s no key was held down, but the robot was still moving. Make" in missed_text
    )


def test_keys_of_the_other_side_are_pressed_in_a_mirrored_world(tmp_path: Path) -> None:
    lesson = lesson_of(
        tmp_path, OBEYS_CRITERION.format(key="KEY_LEFT"), settings="mirror = true\nworlds = 2"
    )
    assert [press.key for seed in (1, 2) for press in presses_of(lesson, seed)] == [
        "KEY_LEFT",
        "KEY_RIGHT",
    ]
    program = answer_to_key("LEFT", "L(0.1, 60)").replace(
        "W(", "IF(KEY_RIGHT); R(0.1, 60); END_IF; W("
    )
    assert findings_of(program, lesson, range(1, 3)) == []
    assert findings_of(answer_to_key("LEFT", "L(0.1, 60)"), lesson, range(1, 3))


def test_held_keys_are_not_the_heartbeat_that_a_run_needs(tmp_path: Path) -> None:
    """A run of the judge's continues without a computer, before the first key and after the
    last."""
    lesson = lesson_of(
        tmp_path, OBEYS_CRITERION.format(key="KEY_A") + '[[criteria]]\nkind = "shows"\n'
    )
    assert (
        sentences_on(lesson, answer_to_key("A", "BEEP(0.1, 440)").replace("W(", "SHOW(TIME); W("))
        == []
    )


def test_instructions_after_a_loop_do_not_count_as_inside(tmp_path: Path) -> None:
    lesson = lesson_of(tmp_path, '[[criteria]]\nkind = "uses"\nwords = ["LOOP"]\n')
    (sentence,) = sentences_on(lesson, "LOOP(2);W(0.1);END_LOOP;BEEP(0.1, 440)")
    assert "repeats nothing" in sentence


def test_a_line_is_followed_or_left(tmp_path: Path) -> None:
    line = '[[criteria]]\nkind = "follows"\nwithin_cm = 9\nat_least_cm = 60\n'
    lesson = lesson_of(tmp_path, line, "liner")
    assert sentences_on(lesson, "B(1.7, 60)") == []
    assert "of the black line; the task asks for 60 cm" in sentences_on(lesson, "B(0.7, 60)")[0]
    assert "left the black line. Look at which way" in sentences_on(lesson, "F(1, 60)")[0]
    wiggle = sentences_on(lesson, "LOOP(FOREVER);L(0.05,20);R(0.05,20);END_LOOP")[0]
    assert "Make it drive faster, and turn less" in wiggle


@pytest.mark.parametrize(
    ("program", "sentence"),
    [
        ("M(50, 50);LED(TRUE);W(1);LED(FALSE);W(0.1);LED(TRUE);W(0.1);S", ""),
        ("M(50, 50);LED(TRUE);W(1);LED(TRUE);W(0.1);S", "LED was switched on 1 of 2 times"),
        (
            "LOOP(2);LED(TRUE);W(0.1);LED(FALSE);W(0.1);END_LOOP;F(1, 50)",
            "LED was switched on 0 of 2 times",
        ),
        (
            "M(50, 50);LED(FALSE);W(1);S",
            "LED was never switched on. Switch it on and off: LED(TRUE)",
        ),
    ],
)
def test_a_lamp_blinks_on_the_way(tmp_path: Path, program: str, sentence: str) -> None:
    """A lamp that is set again without having been off has not blinked."""
    lamp = '[[criteria]]\nkind = "blinks"\nwhat = "LED"\ntimes = 2\n'
    reported_sentences = sentences_on(lesson_of(tmp_path, lamp, "liner"), program)
    assert [sentence in line for line in reported_sentences] == ([True] if sentence else [])


@pytest.mark.parametrize(
    ("word", "task"),
    [
        ("TASK", "TASK;BEEP(0.1, 440);ENDTASK"),
        ("WHEN", "WHEN(TRUE);BEEP(0.1, 440);W(FOREVER) UNTIL(FALSE);END_WHEN"),
    ],
)
def test_a_criterion_may_require_a_task(tmp_path: Path, word: str, task: str) -> None:
    needs = f'[[criteria]]\nkind = "beeps"\n[[criteria]]\nkind = "needs"\nwords = ["{word}"]\n'
    lesson = lesson_of(tmp_path, needs, "tinibot32")
    assert sentences_on(lesson, f"F(1, 50)\n{task}\nW(0.1)") == []
    (sentence,) = sentences_on(lesson, f"F(1, 50)\n{task}\nBEEP(0.1, 440)")
    assert f"just as well without the {word}" in sentence
    (sentence,) = sentences_on(lesson, "BEEP(0.1, 440)")
    assert f"does not use {word}. Use it here: {word}" in sentence


def test_requirements_of_one_world_hold_in_any_order(tmp_path: Path) -> None:
    needs = (
        '[[criteria]]\nkind = "beeps"\ntimes = 2\n[[criteria]]\nkind = "needs"\nwords = ["LOOP"]\n'
    )
    lesson = lesson_of(tmp_path, needs)
    beep = "BEEP(0.1, 440)"
    text = f"IF(RANDOM(1, 3) = 1);LOOP(2);{beep};END_LOOP;ELSE;{beep};{beep};ENDIF"
    worlds = {seed: not findings_of(text, lesson, [seed]) for seed in range(1, 9)}
    needing = [seed for seed in worlds if worlds[seed]][:1]
    others = [seed for seed in worlds if not worlds[seed]][:2]
    assert [finding.kind for finding in findings_of(text, lesson, others)] == ["needs"]
    for seeds in permutations(needing + others):
        assert not findings_of(text, lesson, seeds), seeds


def test_advice_on_a_when_condition_mentions_the_robot(tmp_path: Path) -> None:
    reaches = '[[criteria]]\nkind = "ends_in"\nat = [140, 100]\n'
    lesson = lesson_of(tmp_path, reaches, "tinibot32")
    (sentence,) = sentences_on(lesson, "WHEN(DISTANCE < 4);F(1, 89);END_WHEN")
    assert "Does the condition of WHEN ever become TRUE? See what the robot reads" in sentence


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("PING|check_connection", "begins with PING"),
        ("X = 1 / TIME", "divided by 0"),
        ("X = 2147483 + TIME * 0 + 1", "a number got too large"),
        ("F(2, 0)", "did not move"),
        ("L(90, 60)", "was still moving when time ran out after 10.0 s"),
    ],
)
def test_failures_of_the_whole_run_are_reported(tmp_path: Path, text: str, sentence: str) -> None:
    lesson = lesson_of(tmp_path, '[[criteria]]\nkind = "ends_in"\nat = [140, 100]\n')
    (verdict_line,) = sentences_on(lesson, text)
    assert sentence in verdict_line


@pytest.mark.sampled("body", "ending", keep=2)
@pytest.mark.parametrize(
    ("body", "ending"),
    [
        ("", "still running"),
        ("X = LIGHT_L", "without a pause."),
        ("SHOW(1)", "without a pause."),
        ("M(50, 49)", "without a pause."),
        ("W(0.05)", "still running"),
    ],
)
def test_a_program_that_never_waits_is_ended(tmp_path: Path, body: str, ending: str) -> None:
    """The end comes by actions or by the robot's time, never by the wall clock."""
    lesson = lesson_of(tmp_path, '[[criteria]]\nkind = "ends"\n')
    (sentence,) = sentences_on(lesson, f"LOOP(FOREVER);{body};END_LOOP")
    assert ending in sentence


def test_the_same_seed_gives_the_same_world(tmp_path: Path) -> None:
    settings = "worlds = 3\nnoise_percent = 2\nmirror = true"
    varies = '[[criteria]]\nkind = "never_touches"\n[[varies]]\npart = "boxes[1]"\ny_cm = [5, 30]\n'
    lesson = lesson_of(tmp_path, varies, settings=settings)
    assert vary(lesson, 3) == vary(lesson, 3) != vary(lesson, 5)
    box = lesson.variations[0].place
    assert 105 <= point_of(box, vary(lesson, 1), False).y <= 130
    assert 70 <= point_of(box, vary(lesson, 2), True).y <= 95  # the other way round
    robot = robots.load("tinibot")
    image = image_of(compile_source(b"F(1, 80);L(1, 50)", robot, "p", True), robot)
    tracks = [running.run(image, robot, lesson, seed).track for seed in (1, 1, 3)]
    assert tracks[0] == tracks[1] != tracks[2]


def test_the_button_starts_sb_programs(tmp_path: Path) -> None:
    lesson = lesson_of(tmp_path, '[[criteria]]\nkind = "drives"\nat_least_cm = 30\n')
    assert sentences_on(lesson, "SB|F(1, 89)") == []


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_verdict_has_a_next_step(language: str) -> None:
    for key, sentence in all_said(language, "lessons").items():
        if key.startswith("said/"):
            assert sentence.count(". ") + sentence.count("; ") >= 1, key


def test_a_wall_that_blocks_a_robot_is_reported_before_the_timeout(tmp_path: Path) -> None:
    lesson = lesson_of(
        tmp_path,
        '[[criteria]]\nkind = "ends_in"\nat = [140, 100]\n[[criteria]]\nkind = "never_touches"\n',
    )
    first, second = sentences_on(lesson, "F(FOREVER, 60) UNTIL(DISTANCE = 500)")
    assert "touched a box" in first
    assert "still moving when time ran out after" in second
