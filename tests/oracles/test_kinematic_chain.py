"""The chains of matrices against poses computed by hand, and how the oracle reads lists."""

import numpy as np
import pytest

from axisrig.bench.oracles.kinematics.chain import Chain, tilt_deg
from axisrig.bench.oracles.kinematics.lists import Lists

ARM = {f"trafo[0].param[{k}]": 1e4 * v for k, v in {6: 400, 7: 500, 8: 600, 9: 80}.items()}
ARM |= {"trafo[0].id": 45, "trafo[0].param[10]": 1000000, "trafo[0].param[11]": 500000}


@pytest.mark.parametrize(
    "written",
    [
        {"kinematik[9].param[0]": 1000000},
        {"trafo[3].id": 9, "trafo[3].param[0]": "1000000"},
        {"kin_step[0].trafo[0].type": 9, "kin_step[0].trafo[0].param[0]": 1000000},
    ],
)
def test_the_head_has_its_lever_however_the_list_names_it(written: dict[str, object]) -> None:
    axes = [[1.0, 2.0, 3.0, 0.0, 0.0], [0.0, 0.0, 0.0, 90.0, 90.0], [0.0, 0.0, 0.0, 0.0, -90.0]]
    found = Chain((9,), written, {}, 80.0).tool(axes)
    expected = [[1, 2, -177, 0, 0], [-180, 0, 0, 90, 90], [0, -180, 0, 0, -90]]
    assert found == pytest.approx(np.array(expected), abs=1e-12)


def test_what_the_program_wrote_counts() -> None:
    written = {"trafo[0].id": 9, "trafo[0].param[0]": 1000000}
    found = Chain((9,), written, {(0, 9, 0): 300000.0}, 80.0).tool([[0.0] * 5])
    assert found[0, 2] == pytest.approx(-110, abs=1e-12)


def test_the_robot_in_its_zero_pose_and_straight_down() -> None:
    chain = Chain((45,), ARM, {}, 120.0)
    zero = chain.frame([[0.0] * 6])[0, :3]
    assert zero[:, 3] == pytest.approx((900, 0, 850), abs=1e-9)
    assert zero[:, 2] == pytest.approx((-1, 0, 0), abs=1e-12)
    down = chain.tool([[0.0, 0.0, 0.0, 0.0, 90.0, 0.0]])
    assert down[0] == pytest.approx((700, 0, 650, 0, 0, 0), abs=1e-9)


@pytest.mark.parametrize(
    ("start", "end", "tilt", "l2_mm"),
    [
        (30, 60, 45, 97.980),
        (30, 60, 60, 138.564),
        (30, 0, 60, 138.564),  # without HD3 it is longer up to HD4
        (50, 70, 70, 150.351),
        (10, 31, 31, 91.913),
        (90, 60, 45, 80.0),  # never extended
        (60, 70, 60, 80.0),
    ],
)
def test_the_extended_tool(start: float, end: float, tilt: float, l2_mm: float) -> None:
    program = {(1, 98, 0): 1e6, (1, 98, 1): 1e4 * start, (1, 98, 2): 1e4 * end, (1, 98, 3): 91e4}
    chain = Chain((9, 98), {}, program, 80.0)
    axes = [[0.0, 0.0, 0.0, 33.0, -tilt]]
    assert tilt_deg(chain.direction(axes))[0] == pytest.approx(tilt, abs=1e-9)
    tcp, clamp = chain.frame(axes)[0, :3, 3], chain.clamp_mm(axes)[0]
    assert np.linalg.norm(clamp - tcp) == pytest.approx(l2_mm, abs=5e-4)
    assert np.linalg.norm(tcp) == pytest.approx(100 + l2_mm, abs=5e-4)


def test_axes_without_an_order_follow_as_they_are_numbered() -> None:
    written = {"trafo[0].id": 91, "trafo[0].number_of_axes": 4}
    assert Lists(written, {}).of(0, 91).order() == [0, 1, 2, 3]
    written |= {f"trafo[0].chain[{k}]": place for k, place in enumerate((3, 0, 1, 2))}
    assert Lists(written, {}).of(0, 91).order() == [3, 0, 1, 2]


# A robot of 400 + 500 mm on slides along X and Y: straight down its TCP is 500 mm in X
SLIDES = {
    "trafo[0].id": 210, "trafo[0].group[0].chain[0]": 91, "trafo[0].group[0].chain[1]": 45,
    "trafo[1].id": 91, "trafo[1].zero_orientation[2]": 1,
    "trafo[1].axis[0].type": 1, "trafo[1].axis[0].orientation[0]": 1,
    "trafo[1].axis[1].type": 1, "trafo[1].axis[1].orientation[1]": 1,
    "trafo[2].id": 45, "trafo[2].param[7]": 4000000, "trafo[2].param[8]": 5000000,
}  # fmt: skip
DOWN = (0.0, 0.0, 0.0, 0.0, 90.0, 0.0)


def on_slides(count: int, priority: tuple[int, ...], locked: tuple[int, ...] = ()) -> Chain:
    """The first of priority takes a motion; locked: places of lock_dof."""
    written: dict[str, object] = SLIDES | {"trafo[1].number_of_axes": count}
    written |= {f"trafo[0].group[0].move_prio[{k}]": name for k, name in enumerate(priority)}
    written |= {f"trafo[0].lock_dof[{place}]": 1 for place in locked}
    return Chain((210,), written, {}, 0.0)


@pytest.mark.parametrize(
    ("priority", "locked", "x_mm", "y_mm"),
    [
        ((91, 45), (), -500, 0),
        ((91, 45), (6,), 30, 0),
        ((91, 45), (7,), -500, -40),
        ((91, 45), (6, 7), 30, -40),
        ((45, 91), (), 30, -40),
        ((45, 91), (6, 7), 30, -40),
        ((), (), 30, -40),
    ],
)
def test_a_slide_that_leads_has_its_position_less_that_of_the_tool_and_a_locked_one_its_own(
    priority: tuple[int, ...], locked: tuple[int, ...], x_mm: float, y_mm: float
) -> None:
    """At 30 and -40 mm the TCP is at X 530, Y -40; each lock holds its own slide."""
    tool = on_slides(2, priority, locked).tool([[*DOWN, 30.0, -40.0]])[0]
    assert tool[:2] == pytest.approx((530, -40), abs=1e-9)
    assert tool[6:] == pytest.approx((x_mm, y_mm), abs=1e-9)


@pytest.mark.parametrize(
    ("priority", "locked", "by_mm"),
    [((91, 45), (), 0), ((91, 45), (6,), 100), ((45, 91), (), 100), ((), (6,), 100)],
)
def test_the_coordinate_of_a_slide_stays_where_it_goes_with_the_tool(
    priority: tuple[int, ...], locked: tuple[int, ...], by_mm: float
) -> None:
    """The one slide goes 100 mm with the tool above it, in a pose away from singular ones."""
    pose = (10.0, 20.0, 30.0, -15.0, 40.0, 25.0)
    before, after = on_slides(1, priority, locked).tool([[*pose, 30.0], [*pose, 130.0]])
    assert after - before == pytest.approx((100, 0, 0, 0, 0, 0, by_mm), abs=1e-9)


@pytest.mark.parametrize(
    ("c_deg", "a_deg", "place_mm"),
    [
        (0.0, 0.0, (30.0 + 7.0, 20.0 + 8.0 + 9.0, -2.0 - 100.0 - 80.0)),
        (90.0, 0.0, (7.0 - 20.0 - 9.0, 8.0 + 30.0, -2.0 - 100.0 - 80.0)),
        # The lever of A and the tool lie along -Y then, HD9 stands up
        (0.0, -90.0, (30.0 + 7.0, 20.0 + 8.0 - 180.0, -2.0 - 9.0)),
    ],
)
def test_each_offset_of_a_head_has_its_axis_and_turns_with_what_is_above_it(
    c_deg: float, a_deg: float, place_mm: tuple[float, float, float]
) -> None:
    """HD1 100 and HD2 2 down, HD5 20 in Y and HD6 30 in X turn with C, HD9 9 with A; HD7 7 and HD8
    8 stay.
    """
    sizes = {1: 100, 2: 2, 5: 20, 6: 30, 7: 7, 8: 8, 9: 9}
    written = {f"kinematik[9].param[{number - 1}]": 1e4 * mm for number, mm in sizes.items()}
    found = Chain((9,), written, {}, 80.0).tool([[0.0, 0.0, 0.0, c_deg, a_deg]])
    assert found[0, :3] == pytest.approx(place_mm, abs=1e-9)
