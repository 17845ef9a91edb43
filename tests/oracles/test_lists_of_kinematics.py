"""Which set of a list a kinematic is, and where bases and directions put its parts."""

import numpy as np
import pytest
from tests.oracles.test_kinematic_chain import DOWN, SLIDES

from axisrig.bench.oracles.kinematics.chain import Chain
from axisrig.bench.oracles.kinematics.lists import Lists

LEVER = {"param[0]": 300000}  # HD1: 30 mm


@pytest.mark.parametrize(
    ("written", "step", "wanted", "number", "kind", "hd1"),
    [
        ({"trafo[0].id": 500, "trafo[0].type": 9}, 0, 500, 500, 9, 30.0),
        ({"trafo[0].id": 500, "trafo[0].type": 9}, 0, "500", 500, 9, 30.0),
        ({"trafo[0].id": 9}, 0, 9, 9, 9, 30.0),
        ({"trafo[0].type": 9}, 0, 9, 9, 9, 30.0),
        ({"trafo[0].id": 9, "trafo[0].name": "HEAD"}, 0, "HEAD", 9, 9, 30.0),
        # The kinematic of the second step is in a list of its own
        ({"trafo[0].id": 98}, 1, 98, 98, 98, 0.0),
        ({"kin_step[1].trafo[0].id": 98}, 0, 98, 98, 98, 0.0),
    ],
)
def test_a_set_is_found_by_its_id_its_type_or_its_name(
    written: dict[str, object], step: int, wanted: int | str, number: int, kind: int, hd1: float
) -> None:
    prefix = next(iter(written)).rpartition(".")[0] + "."
    listed = {**written, **{prefix + name: value for name, value in LEVER.items()}}
    found = Lists(listed, {}).of(step, wanted)
    assert (found.id, found.type, found.hd(1)) == (number, kind, hd1)


def test_of_several_sets_each_is_its_own() -> None:
    listed = {
        "trafo[0].id": 9, "trafo[0].param[0]": 10000, "trafo[7].id": 45, "trafo[7].param[0]": 20000,
        "kin_step[0].trafo[2].id": 91, "kin_step[0].trafo[2].param[0]": 30000,
        "kin_step[1].trafo[0].id": 98, "kin_step[1].trafo[0].param[0]": 40000,
        "kinematik[12].param[0]": 50000,
    }  # fmt: skip
    sets = {9: 0, 45: 0, 91: 0, 98: 1, 12: 0}
    found = [Lists(listed, {}).of(step, number).hd(1) for number, step in sets.items()]
    assert found == [1.0, 2.0, 3.0, 4.0, 5.0]


@pytest.mark.parametrize(
    ("place", "hd1"),
    [
        ((0, 500, 0), 7.0),
        ((1, 500, 0), 30.0),  # of the other step
        ((0, 9, 0), 30.0),  # of another kinematic: the ID counts, not the type
        ((0, 500, 1), 30.0),  # HD2
    ],
)
def test_the_program_writes_by_step_id_and_place(place: tuple[int, int, int], hd1: float) -> None:
    listed = {"trafo[0].id": 500, "trafo[0].type": 9, "trafo[0].param[0]": 300000}
    assert Lists(listed, {place: 70000.0}).of(0, 500).hd(1) == hd1


def test_a_zero_of_the_program_counts_too() -> None:
    listed = {"trafo[0].id": 9, "trafo[0].param[0]": 300000}
    assert Lists(listed, {(0, 9, 0): 0.0}).of(0, 9).hd(1) == 0.0


@pytest.mark.parametrize(
    ("chain", "order"),
    [
        ((2, 0, 1), [2, 0, 1]),
        ((1, 1, 0), [0, 1, 2]),  # one is missing: as they are numbered
        ((0, 0, 0), [0, 1, 2]),
        ((2,), [0, 1, 2]),
    ],
)
def test_an_order_that_leaves_an_axis_out_is_none(chain: tuple[int, ...], order: list[int]) -> None:
    listed: dict[str, object] = {"trafo[0].id": 91, "trafo[0].number_of_axes": 3}
    listed |= {f"trafo[0].chain[{k}]": place for k, place in enumerate(chain)}
    assert Lists(listed, {}).of(0, 91).order() == order


@pytest.mark.parametrize(
    "direction",
    [(0, 0, 1), (0, 0, -1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 3, 4), (3, 0, -4)],
)
def test_the_end_of_a_universal_kinematic_looks_where_its_list_says(
    direction: tuple[int, ...],
) -> None:
    """One slide along X at 7 mm, its end 1, 2, 3 mm on; the tool of 80 mm goes against it."""
    listed: dict[str, object] = {
        "trafo[0].id": 91, "trafo[0].number_of_axes": 1,
        "trafo[0].axis[0].type": 1, "trafo[0].axis[0].orientation[0]": 5,
    }  # fmt: skip
    listed |= {f"trafo[0].zero_position[{k}]": 10000 * (k + 1) for k in range(3)}
    listed |= {f"trafo[0].zero_orientation[{k}]": part for k, part in enumerate(direction)}
    chain = Chain((91,), listed, {}, 80.0)
    unit = np.array(direction) / np.linalg.norm(direction)
    assert chain.direction([[7.0]])[0] == pytest.approx(unit, abs=1e-12)
    assert chain.clamp_mm([[7.0]])[0] == pytest.approx((8, 2, 3), abs=1e-12)
    assert chain.frame([[7.0]])[0, :3, 3] == pytest.approx(np.array([8, 2, 3]) - 80 * unit)


@pytest.mark.parametrize(
    ("base", "place_mm"),
    [
        ({}, (530, 0, 400)),
        ({"trafo[2].base[2]": -1000000}, (530, 0, 500)),  # on a slide that is 100 mm high
        ({"trafo[1].base[2]": -1000000}, (530, 0, 500)),  # the slide on a foot
        ({"trafo[2].base[0]": 200000, "trafo[2].base[1]": -300000}, (510, 30, 400)),
        # The slide is turned by 90 degrees under the robot: on the slide the robot is turned by -90
        ({"trafo[2].base[5]": 900000}, (30, -500, 400)),
        ({"trafo[1].base[5]": 900000}, (0, -530, 400)),
        ({"trafo[2].base[4]": 1800000}, (-470, 0, -400)),
        ({"trafo[2].base[3]": 1800000}, (530, 0, -400)),
        # First the turn of A, then that of C
        ({"trafo[2].base[3]": 1800000, "trafo[2].base[5]": 900000}, (30, 500, -400)),
    ],
)
def test_a_base_says_where_the_kinematic_below_is(
    base: dict[str, object], place_mm: tuple[int, ...]
) -> None:
    """The robot straight down is 500 mm along its X and 400 mm high; its slide at 30 mm."""
    listed: dict[str, object] = {**SLIDES, "trafo[1].number_of_axes": 1, **base}
    found = Chain((210,), listed, {}, 0.0).frame([[*DOWN, 30.0]])[0, :3, 3]
    assert found == pytest.approx(place_mm, abs=1e-9)


def test_kinematics_of_a_group_are_named_or_numbered() -> None:
    by_id: dict[str, object] = {
        **SLIDES, "trafo[1].number_of_axes": 1, "trafo[0].group[0].move_prio[0]": 91,
    }  # fmt: skip
    named = {
        **by_id, "trafo[1].name": "SLIDE", "trafo[0].group[0].chain[0]": "SLIDE",
        "trafo[0].group[0].move_prio[0]": "SLIDE",
    }  # fmt: skip
    pose = [[10.0, 20.0, 30.0, -15.0, 40.0, 25.0, 30.0]]
    one, other = (Chain((210,), listed, {}, 0.0).tool(pose)[0] for listed in (by_id, named))
    assert one == pytest.approx(other, abs=1e-12)
    assert one[6] == pytest.approx(30.0 - one[0], abs=1e-9)
