"""A robot and its rivals in a ring: they push each other, and they never overlap."""

from __future__ import annotations

import math
import random
from pathlib import Path

import pytest

from tests.support.casefile import ROOT
from tests.support.virtual_robot import robot_in
from tiniscript import compile, robots
from tiniscript.robots.kinematics import Pose, move_pose
from tiniscript.studio.simulation import Simulation
from tiniscript.virtual import worlds
from tiniscript.virtual.bout import Bout, driving_in
from tiniscript.virtual.driving import Driving
from tiniscript.virtual.geometry import gap_between
from tiniscript.virtual.sensing import Sensing
from tiniscript.virtual.world import Rival, World
from tiniscript.virtual.worlds import read

SUMO = robots.load("sumo")
RING = """
[floor]
width_cm = 200
height_cm = 200
border = false
[start]
x_cm = 60
y_cm = 100
[[rings]]
x_cm = 100
y_cm = 100
radius_cm = 80
edge_cm = 5
"""
HEAD_ON_RIVAL = (
    "[[rivals]]\nx_cm = 100\ny_cm = 100\nheading = 180\nspeed_cm_s = 45\npower_percent = {}\n"
)
SLEEPING_RIVAL = HEAD_ON_RIVAL.format(0)


def bout(text: str, robot: str = "sumo") -> Bout:
    made_bout = driving_in(robots.load(robot).body, read(text, "ring"))
    assert isinstance(made_bout, Bout)
    return made_bout


def draw_crowded_world(rng: random.Random) -> World:
    """Rivals, walls and a robot, without overlaps."""
    text = RING.replace("border = false", f"border = {rng.choice(['true', 'false'])}")
    for x, y in rng.sample([(100, 60), (100, 100), (140, 120), (90, 150)], rng.randint(1, 3)):
        text += (
            f"[[rivals]]\nx_cm = {x}\ny_cm = {y}\nheading = {rng.randint(-180, 180)}\n"
            f"length_cm = {rng.randint(8, 24)}\nwidth_cm = {rng.randint(8, 20)}\n"
            f"power_percent = {rng.randint(0, 100)}\nspeed_cm_s = {rng.randint(20, 80)}\n"
        )
    if rng.random() < 0.5:
        text += "[[walls]]\npoints = [[20, 130], [70, 130]]\n"
        text += "[[boxes]]\nx_cm = 175\ny_cm = 90\nlength_cm = 12\nwidth_cm = 40\n"
    return read(text, "crowded")


def powers(rng: random.Random) -> list[tuple[int, float, float]]:
    """Times in ms, and the powers of the motors from then on."""
    times = sorted(rng.sample(range(8000), 12))
    return [(ms, rng.randint(-100, 100), rng.choice([100, 60, 0, -80])) for ms in times]


def rivals_of(driving: Driving) -> list[Pose]:
    return list(driving.rivals)


# -- the same, however often it is looked at -------------------------------------------------------


@pytest.mark.sampled("seed")
@pytest.mark.parametrize("seed", range(12))
def test_observers_change_nothing(seed: int) -> None:
    rng = random.Random(seed)
    world, moves, body = (
        draw_crowded_world(rng),
        powers(rng),
        robots.load(rng.choice(robots.names())).body,
    )
    end_states = []
    for look_count in (0, 3, 40):
        driving, watch = driving_in(body, world), random.Random(seed + look_count)
        for (ms, left, right), (until, _, _) in zip(moves, [*moves[1:], (9000, 0, 0)], strict=True):
            driving.set_motors(ms, left, right)
            for at_ms in sorted(watch.sample(range(ms, until), min(look_count, until - ms))):
                driving.pose_at(at_ms) if watch.random() < 0.5 else driving.advance_to(at_ms)
        end_states.append(
            (driving.advance_to(9000), rivals_of(driving), driving.bumps, driving.has_fallen)
        )
    assert end_states[0] == end_states[1] == end_states[2]


@pytest.mark.sampled("name", keep=3)
@pytest.mark.parametrize("name", robots.names())
def test_a_program_among_rivals_is_reproducible(name: str) -> None:
    """For every robot, in the shipped world and from its own sensors."""
    image = compile("SI|LOOP(40);M(80,60);W(0.1);M(-20,90);W(0.05);END_LOOP", name).image
    end_states = []
    for pauses in ([7000], [13] * 500 + [500]):
        simulation = Simulation(name, worlds.load("sumo"), image)
        for pause in pauses:
            simulation.advance(pause)
        state = simulation.state()
        end_states.append(
            {key: state[key] for key in ("now_ms", "pose", "rivals", "score", "readings")}
        )
    assert end_states[0] == end_states[1]


# -- bodies ----------------------------------------------------------------------------------------


@pytest.mark.sampled("seed", keep=2)
@pytest.mark.parametrize("seed", range(24))
def test_no_body_ever_overlaps_another(seed: int) -> None:
    rng = random.Random(seed)
    world, moves = draw_crowded_world(rng), powers(rng)
    driving = driving_in(robots.load(rng.choice(robots.names())).body, world)
    assert isinstance(driving, Bout)
    touched_count = 0
    for (ms, left, right), (until, _, _) in zip(moves, [*moves[1:], (9000, 0, 0)], strict=True):
        driving.set_motors(ms, left, right)
        for at_ms in range(ms, until, 7):
            driving.advance_to(at_ms)
            bodies = driving.bodies()
            for k, (hull, pose) in enumerate(bodies):
                for other, place in bodies[:k]:
                    gap_cm = gap_between(hull.spine(pose), other.spine(place))[0]
                    gap = gap_cm - hull.radius_cm - other.radius_cm
                    assert gap > -1e-3, f"{at_ms} ms"
                    touched_count += gap < 0.1
                contact = hull.contact(pose, driving.obstacles)
                assert contact is None or contact.gap_cm > -1e-3, f"{at_ms} ms"
    assert touched_count or not any(rival.power_percent for rival in world.rivals)


@pytest.mark.parametrize("power", [20, 60, 100])
@pytest.mark.parametrize("heading", [0, 30, 90, 180])
def test_a_pushed_rival_moves_in_the_push_direction(heading: int, power: int) -> None:
    """This holds for any orientation: it moves most along its wheels, least sideways."""
    driving = bout(RING + SLEEPING_RIVAL.replace("180", str(heading)))
    [pose_before] = driving.rivals
    driving.set_motors(0, power, power)
    driving.advance_to(6000 * 20 // power)
    [pose_after] = driving.rivals
    assert pose_after.x_cm > pose_before.x_cm + 2
    free = bout(RING + SLEEPING_RIVAL.replace("x_cm = 100\ny_cm = 100", "x_cm = 100\ny_cm = 20"))
    free.set_motors(0, power, power)
    assert driving.driven_cm < free.advance_to(6000 * 20 // power).x_cm - 60 - 2, (
        "it is slowed down"
    )


@pytest.mark.parametrize("speed", [20, 45, 90])
@pytest.mark.parametrize("power", [30, 55, 80])
@pytest.mark.parametrize("rival_power", [30, 55, 80])
def test_the_stronger_one_pushes_the_other_back(power: int, rival_power: int, speed: int) -> None:
    """Head on: that of more power goes ahead, however fast each of them is alone."""
    rival = HEAD_ON_RIVAL.format(rival_power).replace("speed_cm_s = 45", f"speed_cm_s = {speed}")
    driving = bout(RING.replace("x_cm = 60", "x_cm = 80") + rival)
    driving.set_motors(0, power, power)
    met_pose = driving.advance_to(900)
    later = driving.advance_to(1500)
    way = later.x_cm - met_pose.x_cm
    assert (way > 0.5) == (power > rival_power) and (way < -0.5) == (power < rival_power)


def test_a_single_body_moves_as_without_a_ring() -> None:
    """A rival that is far away, and asleep, changes nothing."""
    far_world = RING.replace("x_cm = 60", "x_cm = 30") + SLEEPING_RIVAL.replace(
        "x_cm = 100", "x_cm = 170"
    )
    rng = random.Random(5)
    for _ in range(20):
        left, right = rng.randint(-100, 100), rng.randint(-100, 100)
        driving = bout(far_world)
        driving.set_motors(0, left, right)
        expected = move_pose(SUMO.body, Pose(30, 100, 0), left, right, 400)
        assert driving.advance_to(400) == pytest.approx(expected, abs=1e-6)


def test_a_rival_begins_when_the_robot_first_moves() -> None:
    driving = bout(RING + HEAD_ON_RIVAL.format(60))
    rivals_before = rivals_of(driving)
    driving.advance_to(3000)
    driving.set_motors(3000, 0, 0)
    driving.advance_to(4000)
    assert rivals_of(driving) == rivals_before
    driving.set_motors(4000, 10, 0)
    driving.advance_to(4500)
    assert rivals_of(driving) != rivals_before
    driving.rest()
    rivals_before = rivals_of(driving)
    driving.advance_to(9000)
    assert rivals_of(driving) == rivals_before, "its time is over"


def test_an_unpushed_rival_stays_in_its_ring() -> None:
    rng = random.Random(8)
    for _ in range(6):
        text = RING.replace("x_cm = 60", "x_cm = 8")  # the robot is outside, and seen
        heading, power = rng.randint(-180, 180), rng.choice([30, 60, 100])
        driving = bout(text + HEAD_ON_RIVAL.format(power).replace("180", str(heading)))
        driving.has_fallen = True  # falling does not end this run
        driving.set_motors(0, 1, 0)
        for at_ms in range(0, 20_000, 50):
            driving.advance_to(at_ms)
            [rival] = driving.rivals
            assert math.dist(rival[:2], (100, 100)) < 80


# -- sensing ---------------------------------------------------------------------------------------


def test_a_distance_sensor_sees_where_a_rival_is() -> None:
    rng = random.Random(6)
    count = 0
    for _ in range(200):
        x, y = rng.uniform(40, 160), rng.uniform(40, 160)
        text = RING + f"[[rivals]]\nx_cm = {x:.3f}\ny_cm = {y:.3f}\n"
        driving = bout(text)
        pose = Pose(rng.uniform(30, 170), rng.uniform(30, 170), rng.uniform(0, 360))
        reading = (
            Sensing(SUMO, read(text, "ring"), other_outlines=driving.other_outlines).peek(2, pose)
            / 1000
        )
        along = math.radians(pose.heading)
        eye = (pose.x_cm + 5 * math.cos(along), pose.y_cm + 5 * math.sin(along))
        distance_cm = math.dist(eye, (x, y)) - 5.5
        angle_off = math.atan2(y - eye[1], x - eye[0]) - along
        angle_off = abs((angle_off + math.pi) % (2 * math.pi) - math.pi)
        if angle_off < math.radians(15) and distance_cm > 3:
            count += 1
            assert reading == pytest.approx(distance_cm, abs=0.3)
        elif angle_off > math.radians(60) and distance_cm > 10:
            assert reading == 400
    assert count > 8


def test_black_and_white_areas_are_sensed() -> None:
    """A dark ring, its edge, and the floor around it; a line is black anywhere."""
    world = read(RING + SLEEPING_RIVAL + "[[lines]]\npoints = [[20, 20], [195, 20]]\n", "ring")
    liner = robots.load("liner")
    for x_cm, is_black in ((100, True), (172, True), (177, False), (179, False), (190, False)):
        pose = Pose(x_cm, 100, 90)
        black = liner.body._replace(
            places={"LINE_L": liner.body.places["LINE_L"]._replace(x_cm=0, y_cm=0)}
        )
        white = SUMO.body._replace(
            places={"LINE_L": SUMO.body.places["LINE_L"]._replace(x_cm=0, y_cm=0)}
        )
        assert Sensing(liner._replace(body=black), world).peek(0, pose) == is_black
        assert Sensing(SUMO._replace(body=white), world).peek(0, pose) == (not is_black)
        assert Sensing(SUMO._replace(body=white), world).peek(0, Pose(x_cm, 20, 0)) == 0


@pytest.mark.parametrize("power", [40, 60, 100])
def test_the_edge_is_seen_before_the_robot_is_out(power: int) -> None:
    """This holds in every direction, in time to stop, even at full speed."""
    rng = random.Random(power)
    world = worlds.load("sumo")._replace(rivals=())
    [ring] = world.rings
    asleep = Rival(Pose(ring.place.x, ring.place.y, 0), 11, 11, 40, 0)
    for _ in range(10):
        heading = rng.uniform(0, 360)
        along = math.radians(heading)
        place = (ring.place.x + 20 * math.cos(along), ring.place.y + 20 * math.sin(along))
        driving = driving_in(
            SUMO.body, world._replace(rivals=(asleep,), start=Pose(*place, heading))
        )
        sensing = Sensing(SUMO, world)
        driving.set_motors(0, power, power)
        seen_ms = next(
            at_ms for at_ms in range(0, 20_000, 10)
            if sensing.peek(0, pose := driving.advance_to(at_ms)) or sensing.peek(1, pose)
        )  # fmt: skip
        assert seen_ms > 300 and not driving.has_fallen
        driving.advance_to(seen_ms + 150)
        assert not driving.has_fallen, "150 ms are enough for a program and its motors"
        driving.advance_to(seen_ms + 4000)
        assert driving.has_fallen


# -- how it ends -----------------------------------------------------------------------------------


def run_to_score(program: str, text: str, ms: int = 9000) -> dict[str, int]:
    simulation = Simulation("sumo", read(text, "own"), compile(program, "sumo").image)
    simulation.advance(ms)
    score: dict[str, int] = simulation.state()["score"]
    return score


def test_pushed_out_rivals_and_falls_are_counted() -> None:
    text = RING + SLEEPING_RIVAL + "[task]\nseconds = 20\n"
    won = run_to_score("F(9, 80)", text)
    assert (won["pushed"], won["rivals"], won["stars"], won["has_fallen"]) == (1, 1, 3, False)
    assert won["points"] > 100
    still = run_to_score("W(1)", text)
    assert (still["pushed"], still["stars"], still["has_fallen"]) == (0, 0, False)
    fallen = run_to_score("B(9, 80)", text)
    assert (fallen["pushed"], fallen["stars"], fallen["has_fallen"]) == (0, 0, True)
    flag = "[[flags]]\nx_cm = 0\ny_cm = 100\nreach_cm = 10\n"  # beyond the edge
    assert run_to_score("B(9, 80)", text + flag)["taken"] == 0
    both = run_to_score("B(2, 80);F(20, 80)", text, 25_000)
    assert (both["pushed"], both["stars"], both["has_fallen"]) == (0, 0, True), (
        "it no longer counts"
    )


def test_the_example_pushes_the_rival_of_the_world_out() -> None:
    text = (ROOT / "examples" / "sumo.ts").read_text(encoding="utf-8")
    simulation = Simulation("sumo", worlds.load("sumo"), compile(text).image)
    simulation.advance(1000 * int(worlds.load("sumo").seconds))
    score = simulation.state()["score"]
    assert (score["pushed"], score["stars"], score["has_fallen"]) == (1, 3, False)


def test_faults_of_rivals_in_a_world_are_reported(tmp_path: Path) -> None:
    from tiniscript.robots.refusals import describe
    from tiniscript.virtual.world import WorldRefused

    for wrong, message in (
        (SLEEPING_RIVAL * 4, "rivals has 4 parts. Keep at most 3"),
        ("[[rivals]]\nx_cm = 5\n", "rivals[1].y_cm is missing"),
        (SLEEPING_RIVAL + "lenght_cm = 7\n", "Did you mean length_cm?"),
        ("[[rings]]\nx_cm = 5\ny_cm = 5\n", "rings[2].radius_cm is missing"),
    ):
        with pytest.raises(WorldRefused) as exception_info:
            read(RING + wrong, "wrong")
        assert any(message in line for line in describe(exception_info.value, "en")), describe(
            exception_info.value, "en"
        )


def test_a_robot_that_begins_in_a_rival_is_refused() -> None:
    from tiniscript.virtual.world import WorldRefused

    with pytest.raises(WorldRefused, match="start_blocked"):
        robot_in(
            read(RING + SLEEPING_RIVAL.replace("x_cm = 100\n", "x_cm = 66\n"), "tight"), "sumo"
        )
