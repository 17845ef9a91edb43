"""Which numbers make a kinematic: of which step and set, their limits, which axis moves."""

import math
from collections.abc import Mapping

import pytest
from tests.kinematics.machines import TABLE, UNIVERSAL

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.kinematics import (
    Kinematic,
    KinematicData,
    build,
    check_axes,
    check_known,
)
from axisrig.kernel.kinematics.table import offsets
from axisrig.kernel.parameters import Origin, ParameterSet

# A robot of 400 and 500 mm on slides along X and Y, at the height of their end
CROSS = """trafo[0].id 210
trafo[0].group[0].chain[0] 91
trafo[0].group[0].chain[1] 45
trafo[1].id 91
trafo[1].number_of_axes 2
trafo[1].zero_orientation[2] 1
trafo[1].axis[0].type 1
trafo[1].axis[0].orientation[0] 1
trafo[1].axis[1].type 1
trafo[1].axis[1].orientation[1] 1
trafo[2].id 45
trafo[2].param[7] 4000000
trafo[2].param[8] 5000000"""
THIRD = "\ntrafo[1].axis[2].type 1\ntrafo[1].axis[2].orientation[2] 1"
SLIDES_FIRST = "\ntrafo[0].group[0].move_prio[0] 91\ntrafo[0].group[0].move_prio[1] 45"
ROBOT_FIRST = "\ntrafo[0].group[0].move_prio[0] 45\ntrafo[0].group[0].move_prio[1] 91"
DOWN = (0.0, 0.0, 0.0, 0.0, 90.0, 0.0)
Written = Mapping[tuple[int, ...], float]


def data(text: str) -> KinematicData:
    channel = ParameterSet("channel")
    for number, line in enumerate(text.splitlines(), 1):
        if line:
            channel.load(*line.split(), Origin("channel.lst", number))
    return KinematicData.read(channel)


def made(text: str, *ids: int, written: Written | None = None, tool_mm: float = 0.0) -> Kinematic:
    return build(ids, data(text), written or {}, tool_mm)


# --- whose numbers -----------------------------------------------------------------------------


@pytest.mark.parametrize("key", [(1, 91, 3), (0, 9, 3), (0, 92, 3)])
def test_what_a_program_wrote_for_another_step_or_set_is_not_for_this_one(
    key: tuple[int, ...],
) -> None:
    pose = (1.0, 2.0, 3.0, 40.0, 50.0)
    plain = made(UNIVERSAL, 91).forward(pose)
    assert made(UNIVERSAL, 91, written={key: 64000}).forward(pose) == plain
    assert made(UNIVERSAL, 91, written={(0, 91, 3): 64000}).forward(pose) != plain


def test_of_two_sets_of_one_type_each_has_its_own_numbers() -> None:
    text = "".join(
        f"trafo[{at}].id {number}\ntrafo[{at}].type 9\ntrafo[{at}].param[0] {hd1}\n"
        for at, number, hd1 in ((0, 21, 100000), (1, 22, 250000))
    )
    origin = (0.0,) * 5
    assert made(text, 21).forward(origin)[2] == pytest.approx(-10.0)
    assert made(text, 22).forward(origin)[2] == pytest.approx(-25.0)
    written = {(0, 22, 0): 300000.0}
    assert made(text, 21, written=written).forward(origin)[2] == pytest.approx(-10.0)
    assert made(text, 22, written=written).forward(origin)[2] == pytest.approx(-30.0)


@pytest.mark.parametrize("step", [0, 1])
def test_an_older_list_is_there_in_both_steps(step: int) -> None:
    steps = data("kinematik[98].param[3] 800000\nkinematik[9].param[0] 7").steps
    assert steps[step][98].number("param[]", 3) == 800000
    assert steps[step][98].number("param[]", 2) == 0
    assert steps[step][9].number("param[]", 0) == 7
    assert (steps[step][9].id, steps[step][9].type) == (9, 9)


def test_two_sets_of_one_id_are_refused_where_the_second_one_is() -> None:
    text = "trafo[0].id 9\n\n\ntrafo[3].id 45\ntrafo[1].id 45\n\ntrafo[2].id 9"
    with pytest.raises(UserError, match="kinematic 9 has two sets") as caught:
        data(text)
    assert (caught.value.line, caught.value.value) == (7, 9)


def test_a_name_is_there_with_any_of_its_elements() -> None:
    trafo = data("trafo[0].id 91\ntrafo[0].chain[2] 0").steps[0][91]
    assert trafo.has("chain[]")
    assert not trafo.has("rtcp")
    assert trafo.word("group[].chain[]", 0, 0) == ""


def test_every_offset_of_a_kinematic_is_described_once_and_in_order() -> None:
    """HD13 of kinematic 45 means nothing."""
    used = {9: range(1, 10), 45: (*range(1, 13), 14, 15), 98: range(1, 5)}
    for number, places in used.items():
        rows = [row for row in offsets() if row.id == number]
        assert [row.hd for row in rows] == list(places)
        assert {row.unit for row in rows} == {"0.0001 mm", "0.0001 deg"}
        assert all(row.meaning for row in rows)


@pytest.mark.parametrize(
    ("line", "param", "pose"),
    [
        ("zero_position[2] -950000", 5, (1.0, 2.0, 3.0, 40.0, 50.0)),
        ("axis[4].point[1] -245000", 7 + 7 * 4 + 5, (1.0, 2.0, 3.0, 40.0, 50.0)),
        ("axis[3].orientation[2] 1", 7 + 7 * 3 + 3, (1.0, 2.0, 3.0, 40.0, 50.0)),
    ],
)
def test_a_set_of_another_id_takes_what_a_program_writes_for_its_id(
    line: str, param: int, pose: tuple[float, ...]
) -> None:
    """Also where the list has the number under its own name; numbers for the type are not its."""
    text = UNIVERSAL.replace("trafo[2].id 91", "trafo[2].id 7\ntrafo[2].type 91")
    name, value = line.split()
    other = 500000 if abs(float(value)) > 1 else -float(value)
    assert UNIVERSAL.count(f"trafo[2].{line}") == 1
    wanted = made(text.replace(f"{name} {value}", f"{name} {other:g}"), 7).forward(pose)
    plain = made(text, 7).forward(pose)
    assert wanted != plain
    assert made(text, 7, written={(0, 7, param): other}).forward(pose) == wanted
    for key in ((0, 91, param), (1, 7, param)):
        assert made(text, 7, written={key: other}).forward(pose) == plain


# --- limits of chains --------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("count", "allowed"),
    [(7.0, "3 to 6"), (3.5, "3 to 6"), (2.0, "3 to 6"), (0.0, "3 to 6"), (-3.0, "3 to 6")],
)
def test_a_chain_has_three_to_six_axes(count: float, allowed: str) -> None:
    with pytest.raises(Alarm, match="number_of_axes of kinematic 91") as caught:
        made(UNIVERSAL, 91, written={(0, 91, 6): count})
    assert caught.value.values["value"] == f"{count:g}"
    assert caught.value.values["allowed"] == allowed
    assert made(TABLE, 91).count == 6


def test_three_linear_axes_are_a_chain_whatever_rtcp_is() -> None:
    """Without a rotary axis there is nothing to turn; the tool is below zero_position[]."""
    text = UNIVERSAL.replace("number_of_axes 5", "number_of_axes 3").replace("rtcp 1", "rtcp 0")
    kinematic = made(text, 91, tool_mm=80.0)
    assert (kinematic.count, kinematic.rotary) == (3, (False,) * 3)
    tool = kinematic.forward((10.0, 20.0, 30.0))
    assert tool == pytest.approx((5.4 + 10.0, -39.5 + 20.0, -95.0 + 30.0 - 80.0))
    assert kinematic.inverse(tool, tool) == pytest.approx((10.0, 20.0, 30.0))


@pytest.mark.parametrize("kind", [0.0, 1.5, 3.0, -1.0])
def test_an_axis_is_linear_or_rotary(kind: float) -> None:
    with pytest.raises(Alarm, match=r"axis\[4\]\.type of kinematic 91") as caught:
        made(UNIVERSAL, 91, written={(0, 91, 7 + 7 * 4): kind})
    assert caught.value.values["value"] == f"{kind:g}"
    assert caught.value.values["allowed"] == "1 (linear) and 2 (rotary)"


@pytest.mark.parametrize(("place", "shown"), [(0, 2), (2, 2), (3, 1), (4, 1)])
def test_linear_axes_come_first(place: int, shown: int) -> None:
    key = (0, 91, 7 + 7 * place)
    with pytest.raises(Alarm, match=rf"axis\[{place}\]\.type .* is {shown} .* first three axes"):
        made(UNIVERSAL, 91, written={key: float(shown)})


@pytest.mark.parametrize(
    ("hd8", "hd9", "hd12", "refused"),
    [
        (0, 300, 0, "HD8 of kinematic 45 is 0 "),
        (-400, 300, 0, "HD8 of kinematic 45 is -400 "),
        (400, 0, 0, "HD9 of kinematic 45 is 0 "),
        (400, 0, 50, None),
        (400, 0, -50, None),
        (400, 300, 0, None),
        (400, -300, 0, None),
    ],
)
def test_an_arm_has_a_length(hd8: float, hd9: float, hd12: float, refused: str | None) -> None:
    written = {(0, 45, 7): 1e4 * hd8, (0, 45, 8): 1e4 * hd9, (0, 45, 11): 1e4 * hd12}
    if refused is None:
        assert made("", 45, written=written).count == 6
        return
    with pytest.raises(Alarm, match=refused):
        made("", 45, written=written)


# --- what fits a channel -----------------------------------------------------------------------


def _axes(text: str) -> list[tuple[str, bool]]:
    return [(name.rstrip("*"), name.endswith("*")) for name in text.split()]


@pytest.mark.parametrize(
    ("text", "ids", "axes", "needed"),
    [
        (UNIVERSAL, (91,), "X Y Z A", "linear, linear, linear, rotary, rotary"),
        (UNIVERSAL, (91,), "X Y Z* A* B*", "linear, linear, linear, rotary, rotary"),
        ("", (9,), "", "X (linear), Y (linear), Z (linear), C (rotary), A (rotary)"),
        (
            CROSS, (210,), "X* Y* Z* A* B* C* U V*",
            "X (rotary), Y (rotary), Z (rotary), A (rotary), B (rotary), C (rotary), linear,"
            " linear",
        ),
    ],
)  # fmt: skip
def test_axes_that_do_not_fit_are_refused_with_those_that_would(
    text: str, ids: tuple[int, ...], axes: str, needed: str
) -> None:
    with pytest.raises(Alarm) as caught:
        check_axes(made(text, *ids), _axes(axes))
    values = caught.value.values
    assert caught.value.id == 292040
    assert (values["name"], values["needed"]) == (str(ids[0]), needed)
    words = [f"{name} ({'rotary' if turns else 'linear'})" for name, turns in _axes(axes)]
    assert values["axes"] == (", ".join(words) or "none")


@pytest.mark.parametrize(
    ("text", "ids", "axes"),
    [(UNIVERSAL, (91,), "U V W Q* R* X"), (CROSS, (210,), "X* Y* Z* A* B* C* U V W*")],
)
def test_axes_of_any_other_names_fit(text: str, ids: tuple[int, ...], axes: str) -> None:
    check_axes(made(text, *ids), _axes(axes))


@pytest.mark.parametrize(
    ("ids", "alarm", "values"),
    [
        ((9, 98), None, {}),
        ((9, 98, 13), None, {}),  # how many there may be is another question
        ((13,), 292005, {"id": 13, "step": 0}),
        ((9, 13), 292005, {"id": 13, "step": 1}),
        ((9, 5), 900440, {"id": 5}),
        ((96, 13), 900440, {"id": 96}),
    ],
)
def test_ids_are_known_step_by_step(
    ids: tuple[int, ...], alarm: int | None, values: dict[str, int]
) -> None:
    if alarm is None:
        check_known(ids, KinematicData())
        return
    with pytest.raises(Alarm) as caught:
        check_known(ids, KinematicData())
    assert caught.value.id == alarm
    assert {name: caught.value.values[name] for name in values} == values


# --- which axis takes a motion -----------------------------------------------------------------


def _reached(text: str, x: float, y: float) -> tuple[float, ...]:
    """Where the slides go for a wrist at (x, y) and the height of joint 2, in mm."""
    kinematic = made(text, 210)
    tool = (x, y, 0.0, 0.0, 0.0, 0.0)
    found = kinematic.inverse((*tool, 0.0, 0.0), (*DOWN, 0.0, 0.0))
    assert kinematic.forward(found)[:6] == pytest.approx(tool, abs=1e-6)
    return found[6:]


X_OF_600 = 800.0 - math.sqrt(900.0**2 - 600.0**2)
Y_OF_800 = 600.0 - math.sqrt(900.0**2 - 800.0**2)


@pytest.mark.parametrize(
    ("lock", "x", "y", "slides"),
    [
        ("", 800.0, 600.0, (X_OF_600, 0.0)),  # the shorter way of both
        ("", 600.0, 800.0, (0.0, X_OF_600)),
        ("", -800.0, 600.0, (-X_OF_600, 0.0)),
        ("", 600.0, -800.0, (0.0, -X_OF_600)),
        ("\ntrafo[0].lock_dof[6] 1", 800.0, 600.0, (0.0, Y_OF_800)),
        ("\ntrafo[0].lock_dof[7] 1", 600.0, 800.0, (Y_OF_800, 0.0)),
        ("\ntrafo[0].lock_dof[7] 1", 800.0, 600.0, (X_OF_600, 0.0)),
        ("", 1000.0, 0.0, (100.0, 0.0)),
        ("", 0.0, -1250.0, (0.0, -350.0)),
        ("", 700.0, 500.0, (0.0, 0.0)),  # in reach
    ],
)
def test_the_slide_with_the_shortest_way_makes_up_for_the_robot(
    lock: str, x: float, y: float, slides: tuple[float, ...]
) -> None:
    """400 + 500 mm: a circle of 900 mm, which a slide meets at sqrt(900² - other²)."""
    for priority in ("", ROBOT_FIRST):
        assert _reached(CROSS + lock + priority, x, y) == pytest.approx(slides, abs=1e-6)


def test_without_a_free_slide_the_robot_says_how_far_it_misses() -> None:
    lock = "\ntrafo[0].lock_dof[6] 1\ntrafo[0].lock_dof[7] 1"
    with pytest.raises(Alarm, match=r"100\.0000 mm outside .* 100 to 900 mm from joint 2"):
        _reached(CROSS + lock, 800.0, 600.0)


@pytest.mark.parametrize(
    ("more", "leads"),
    [
        ("", (False, False)),
        (ROBOT_FIRST, (False, False)),
        (SLIDES_FIRST, (True, True)),
        (SLIDES_FIRST + "\ntrafo[0].lock_dof[6] 1", (False, True)),
        (SLIDES_FIRST + "\ntrafo[0].lock_dof[7] 1", (True, False)),
        (SLIDES_FIRST + "\ntrafo[0].lock_dof[6] 1\ntrafo[0].lock_dof[7] 1", (False, False)),
        (SLIDES_FIRST + "\ntrafo[0].lock_dof[7] 0", (True, True)),
    ],
)
def test_each_slide_goes_with_the_tool_or_stays_where_it_is_programmed(
    more: str, leads: tuple[bool, bool]
) -> None:
    """A tool that goes by (30, -40): a slide that leads goes by its part of it."""
    kinematic = made(CROSS + more, 210)
    start = (10.0, 20.0, 30.0, 5.0, 60.0, 7.0, 100.0, 200.0)
    x, y, *rest = kinematic.forward(start)
    found = kinematic.inverse((x + 30.0, y - 40.0, *rest), start)
    wanted = [100.0 + 30.0 * leads[0], 200.0 - 40.0 * leads[1]]
    assert found[6:] == pytest.approx(wanted, abs=1e-9)
    own = [q - at if led else q for q, at, led in zip(start[6:], (x, y), leads, strict=True)]
    assert rest[4:] == pytest.approx(own, abs=1e-9)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("\ntrafo[0].lock_dof[5] 1", r"lock_dof\[5\] .* is 1 .* lock_dof\[6\] and lock_dof\[7\]"),
        ("\ntrafo[0].lock_dof[8] 1", r"lock_dof\[8\] .* is 1 .* lock_dof\[6\] and lock_dof\[7\]"),
        (
            "\ntrafo[0].group[0].move_prio[0] 45\ntrafo[0].group[0].move_prio[1] 45",
            r"move_prio\[\] of kinematic 210 is 45 45",
        ),
        (
            "\ntrafo[0].group[0].move_prio[0] 91\ntrafo[0].group[0].move_prio[1] HEAD",
            r"move_prio\[\] of kinematic 210 is 91 HEAD",
        ),
    ],
)
def test_who_is_locked_or_first_is_one_of_the_group(more: str, message: str) -> None:
    with pytest.raises(Alarm, match=message):
        made(CROSS + more, 210)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("axis[1].type 1", "axis[1].type 2", "number_of_axes .* is 2 .* 1 or 2 linear axes"),
        ("orientation[1] 1", "orientation[0] -2", r"axis\[1\]\.orientation\[\] .* that of axis"),
        ("chain[1] 45", "chain[1] ROBOT", r"chain\[\] of kinematic 210 is 91 ROBOT"),
        ("chain[0] 91", "chain[0] 93", r"chain\[\] of kinematic 210 is 93 45"),
        ("number_of_axes 2", f"number_of_axes 3{THIRD}", "number_of_axes .* is 3 .* 1 or 2 linear"),
    ],
)
def test_a_group_is_a_robot_on_slides_of_two_directions(old: str, new: str, message: str) -> None:
    assert CROSS.count(old) == 1
    with pytest.raises(Alarm, match=message):
        made(CROSS.replace(old, new), 210)


def test_members_of_a_group_are_found_by_the_name_of_their_set() -> None:
    named = CROSS.replace("chain[0] 91", "chain[0] TABLE").replace("chain[1] 45", "chain[1] ARM")
    named += "\ntrafo[1].name TABLE\ntrafo[2].name ARM\ntrafo[0].group[0].move_prio[0] TABLE"
    pose = (10.0, 20.0, 30.0, 5.0, 60.0, 7.0, 100.0, 200.0)
    expected = made(CROSS + SLIDES_FIRST, 210).forward(pose)
    assert made(named, 210).forward(pose) == expected


def test_a_number_in_a_group_is_an_id_whatever_a_set_is_called() -> None:
    """A robot of the ID 45, and another one of the ID 5 with the name 45."""
    other = "\ntrafo[3].id 5\ntrafo[3].type 45\ntrafo[3].name 45\ntrafo[3].param[7] 9000000"
    other += "\ntrafo[3].param[8] 9000000"
    pose = (10.0, 20.0, 30.0, 5.0, 60.0, 7.0, 100.0, 200.0)
    assert made(CROSS + other, 210).forward(pose) == made(CROSS, 210).forward(pose)
    of_5 = CROSS.replace("chain[1] 45", "chain[1] 5")
    assert made(of_5 + other, 210).forward(pose) != made(CROSS, 210).forward(pose)
