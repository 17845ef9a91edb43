"""From IDs, lists and what a program wrote to a kinematic; what is refused and why."""

import math
from collections.abc import Mapping, Sequence

import pytest
from tests.kinematics.machines import MACHINES, ROBOT_HD

from axisrig.kernel.errors import Alarm, UserError
from axisrig.kernel.kinematics import (
    HeadCA,
    Kinematic,
    KinematicData,
    build,
    check_axes,
    kinematic_types,
)
from axisrig.kernel.parameters import Origin, ParameterSet

HERE = Origin("channel.lst", 1)
REFUSED = [row.id for row in kinematic_types().values() if not row.acts]


def _data(text: str) -> KinematicData:
    channel = ParameterSet("channel")
    for line in text.splitlines():
        channel.load(*line.split(), HERE)
    return KinematicData.read(channel)


def _build(
    ids: Sequence[int],
    text: str = "",
    written: Mapping[tuple[int, ...], float] | None = None,
    tool_mm: float = 80.0,
) -> Kinematic:
    return build(ids, _data(text), written or {}, tool_mm)


def _hd(
    values: Sequence[float], kinematic_id: int = 98, step: int = 1
) -> dict[tuple[int, ...], float]:
    return {(step, kinematic_id, k): 1e4 * value for k, value in enumerate(values)}


# --- where parameters come from ------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "trafo[0].id 9\ntrafo[0].param[0] 1000000",
        "kin_step[0].trafo[3].id 9\nkin_step[0].trafo[3].param[0] 1000000",
        "kinematik[9].param[0] 1000000",
        "kinematik[9].param[0] 7\ntrafo[0].id 9\ntrafo[0].param[0] 1000000",
        "trafo[0].type 9\ntrafo[0].param[0] 1000000",
    ],
)
def test_the_lists_name_an_offset_in_older_and_newer_ways(text: str) -> None:
    assert _build([9], text).forward((0, 0, 0, 0, 0)) == (0, 0, -180, 0, 0)


def test_a_set_of_parameters_may_have_another_id_than_its_type() -> None:
    text = "trafo[0].id 9\ntrafo[1].id 12\ntrafo[1].type 9\ntrafo[1].param[1] 500000"
    assert _build([9], text).forward((0, 0, 0, 0, 0))[2] == -80
    assert _build([12], text).forward((0, 0, 0, 0, 0))[2] == -130
    assert _build([12], text).name == "12"


def test_what_the_program_wrote_counts_before_the_list() -> None:
    text = "trafo[0].id 9\ntrafo[0].param[0] 1000000\ntrafo[0].param[1] 200000"
    assert _build([9], text, {(0, 9, 0): 300000}).forward((0, 0, 0, 0, 0))[2] == -130


@pytest.mark.parametrize(("kinematic", "at"), [(9, 1), (45, 6), (45, 9)])
def test_a_0_that_the_program_wrote_counts_before_the_list(kinematic: int, at: int) -> None:
    arms = f"trafo[0].id {kinematic}\ntrafo[0].param[7] 4000000\ntrafo[0].param[8] 3000000"
    pose, offset = (10.0, 20.0, 30.0, 40.0, 50.0, 60.0), f"{arms}\ntrafo[0].param[{at}] 200000"
    own = _build([kinematic], offset, {(0, kinematic, at): 0.0})
    pose = pose[: own.count]
    assert own.forward(pose) == _build([kinematic], arms).forward(pose)
    assert own.forward(pose) != _build([kinematic], offset).forward(pose)


def test_a_kinematic_without_parameters_has_all_of_them_0() -> None:
    assert _build([9], tool_mm=0.0).forward((1, 2, 3, 4, 5)) == (1, 2, 3, 4, 5)


@pytest.mark.parametrize(
    ("text", "ids"),
    [
        ("", ()),
        ("kinematik_id 9", (9,)),
        ("kinematik_id 9\ndefault_id_of_kin_step[1] 98", (9, 98)),
        ("kinematik_id 45\ndefault_id_of_kin_step[0] 9", (9,)),
        ("kinematik_id 45\ndefault_id_of_kin_step[0] 9\ndefault_id_of_kin_step[1] 98", (9, 98)),
        ("default_id_of_kin_step[1] 98", (0, 98)),  # which is refused: no kinematic has the ID 0
    ],
)
def test_trafo_on_alone_takes_the_default_of_each_step(text: str, ids: tuple[int, ...]) -> None:
    assert _data(text).default_ids == ids


def test_two_sets_with_one_id_are_refused() -> None:
    with pytest.raises(UserError, match=r"channel.lst:1: kinematic 9 has two sets .* own ID"):
        _data("trafo[0].id 9\ntrafo[1].id 9")


def test_an_id_may_stand_for_other_sets_in_the_other_step() -> None:
    """A head of ID 7 in step 0 and an extension of ID 7 in step 1; in one step it is refused."""
    text = "kin_step[0].trafo[0].id 7\nkin_step[0].trafo[0].type 9\nkin_step[0].trafo[0].param[0] 2"
    text += "\nkin_step[1].trafo[0].id 7\nkin_step[1].trafo[0].type 98"
    text += "\nkin_step[1].trafo[0].param[0] 3"
    for lines in (text.splitlines(), reversed(text.splitlines())):
        steps = _data("\n".join(lines)).steps
        found = [(step[7].type, step[7].number("param[]", 0)) for step in steps]
        assert found == [(9, 2.0), (98, 3.0)]
    for step in (0, 1):
        twice = f"kin_step[{step}].trafo[1].id 7\nkin_step[{step}].trafo[1].type 9"
        with pytest.raises(UserError, match="kinematic 7 has two sets of parameters in one step"):
            _data(f"{text}\n{twice}")


# --- what cannot be chosen -----------------------------------------------------------------------


@pytest.mark.provokes(292005, 2, id=13, step=0)
def test_an_unknown_id_names_what_acts() -> None:
    with pytest.raises(Alarm, match=r"13 is not known in step 0.*9, 45, 91, 98, 210"):
        _build([13])


@pytest.mark.provokes(900440, 2)
@pytest.mark.parametrize("kinematic_id", REFUSED)
def test_what_is_refused_says_why(kinematic_id: int) -> None:
    row = kinematic_types()[kinematic_id]
    with pytest.raises(Alarm, match=f"{row.name}.*{row.reason}"):
        _build([kinematic_id])


def test_these_are_refused() -> None:
    assert REFUSED == [5, 6, 7, 8, 10, 96]


@pytest.mark.provokes(900441, 2)
@pytest.mark.parametrize(
    ("ids", "reason"),
    [
        ([98], "Kinematic 98 cannot be chosen together: 98 extends the tool of another"),
        ([98, 9], "second step after it"),
        ([9, 9], "only 98 is a second step and 9 is 5-axis head"),
        ([9, 98, 98], "3 steps"),
        ([], "No kinematic cannot"),
    ],
)
def test_combinations_that_do_not_exist(ids: Sequence[int], reason: str) -> None:
    with pytest.raises(Alarm, match=reason):
        _build(ids)


# --- axes ----------------------------------------------------------------------------------------


def _axes(text: str) -> list[tuple[str, bool]]:
    return [(name.rstrip("*"), name.endswith("*")) for name in text.split()]


@pytest.mark.parametrize("axes", ["X Y Z C* A*", "X Y Z C* A* W", "X1 Y1 Z1 B* D*"])
def test_these_axes_fit_the_head(axes: str) -> None:
    check_axes(_build([9]), _axes(axes))


@pytest.mark.provokes(292040, 2, name="9")
@pytest.mark.parametrize(
    "axes",
    ["", "X Y Z C*", "X Y Z A* C*", "Y X Z C* A*", "X Y Z C A", "X Y Z C* C*", "X X Z C* A*"],
)
def test_these_axes_do_not(axes: str) -> None:
    words = r"needs the axes X \(linear\), Y \(linear\), Z \(linear\), C \(rotary\), A \(rotary\)"
    with pytest.raises(Alarm, match=words):
        check_axes(_build([9]), _axes(axes))


# --- kinematic 98 --------------------------------------------------------------------------------


@pytest.mark.provokes(900442, 2, id=98)
@pytest.mark.parametrize(
    ("hd", "message"),
    [
        ((0, 60, 30, 91), "HD3 of kinematic 98 is 30 and allowed is HD2 = 60 up to below 90 deg"),
        ((0, 30, 90, 91), "HD3 of kinematic 98 is 90"),
        ((0, 30, 60, 0), "HD4 of kinematic 98 is 0 and allowed is above 0"),
        ((0, -1, 60, 91), "HD2 of kinematic 98 is -1 and allowed is 0 to 180 deg"),
        ((0, 0, 0, 91), "HD4 of kinematic 98 is 91 and allowed is below 90 deg where HD3 is 0"),
        ((0, 0, 0, 90), "HD4 of kinematic 98 is 90 and allowed is below 90 deg where HD3 is 0"),
        ((0, 0, 60, 180.5), "HD4 of kinematic 98 is 180.5 and allowed is above 0 up to 180 deg"),
        ((0, 180.5, 60, 91), "HD2 of kinematic 98 is 180.5"),
        ((), "HD4 of kinematic 98 is 0"),
    ],
)
def test_angles_of_98_that_do_not_fit(hd: Sequence[float], message: str) -> None:
    with pytest.raises(Alarm, match=message):
        _build([9, 98], written=_hd(hd))


@pytest.mark.parametrize(
    ("names", "fits"),
    [
        ("XYZCA", True),
        ("XYZCAX", True),  # what follows is none of its axes
        ("XXZCA", False),
        ("XYZCC", False),
        ("UVWCA", True),  # other names at all places
        ("UUWCA", False),
        ("YXZCA", False),
        ("ZYWCA", False),  # the place of Z has another one
        ("UVYCA", False),
        ("UVWAB", False),
        ("XYZC", False),
    ],
)
def test_axes_of_a_kinematic_are_there_once_and_at_their_places(names: str, fits: bool) -> None:
    head = HeadCA((0.0,), 80.0)
    axes = [(name, name in "CA" or place in (3, 4)) for place, name in enumerate(names)]
    if fits:
        check_axes(head, axes)
        return
    with pytest.raises(Alarm) as caught:
        check_axes(head, axes)
    assert caught.value.id == 292040


@pytest.mark.parametrize(
    "hd", [(0, 0, 0, 89.9), (0, 30, 30, 91), (0, 0, 60, 180), (0, 180, 0, 91), (0, 90, 10, 180)]
)
def test_angles_of_98_at_their_very_ends_fit(hd: Sequence[float]) -> None:
    """Never extended from HD2 = 90 on: HD3 is not used there."""
    assert _build([9, 98], written=_hd(hd)).count == 5


@pytest.mark.parametrize("second", [9, 45, 91])
@pytest.mark.parametrize("first", [9, 45, 91])
def test_only_an_extension_follows_another_kinematic(first: int, second: int) -> None:
    """Whether both are of one kind or not, and before any of their parameters is looked at."""
    with pytest.raises(Alarm) as refused:
        _build([first, second])
    assert refused.value.id == 900441
    assert f"only 98 is a second step and {second} is" in str(refused.value.values["reason"])


@pytest.mark.parametrize("number", [7, 10])
def test_what_the_program_wrote_for_the_robot_of_a_group_counts_in_the_group(number: int) -> None:
    """HD7 and HD10 of kinematic 2, a robot on the slide of kinematic 210: 1 mm more."""
    lists = MACHINES["210 slide first"]
    index = number - 1
    own_mm = ROBOT_HD[index]
    plain = lists.kernel()
    written = _build([210], lists.text, {(0, 2, index): (own_mm + 1.0) * 1e4}, tool_mm=80.0)
    pose = (10.0, 20.0, -30.0, 40.0, 50.0, 60.0, 100.0)
    before, after = plain.forward(pose)[:3], written.forward(pose)[:3]
    assert math.dist(before, after) == pytest.approx(1.0)
    same = _build([210], lists.text, {(0, 2, index): own_mm * 1e4}, tool_mm=80.0)
    assert same.forward(pose) == pytest.approx(plain.forward(pose))
