"""How long set positions may go on after an alarm, from lists and speed."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.faults.made_runs import BRAKES, LISTS, alarm, braked, left

from axisrig.bench.tools.scenarios.invariants import stops
from axisrig.bench.tools.scenarios.left import Left
from axisrig.bench.tools.scenarios.stopping import stop_ns
from axisrig.kernel.time.clock import MS

RAMPED = {
    **LISTS,
    "getriebe[0].dynamik.tr_min": 0,
    "getriebe[0].slope_profil.a_beschl": 1000,
    "getriebe[0].slope_profil.a_brems": 2000,
    "getriebe[0].slope_profil.a_grenz": 4000,
    "getriebe[0].slope_profil.a_feedh": 500,
    **{f"getriebe[0].slope_profil.tr_{name}": 10_000 for name in ("grenz", "feedh")},
    **{f"getriebe[0].slope_profil.tr_beschl_{name}": 5000 for name in ("zu", "ab")},
    "getriebe[0].slope_profil.tr_brems_zu": 10_000,
    "getriebe[0].slope_profil.tr_brems_ab": 30_000,
}


@pytest.mark.parametrize(
    ("channel", "lists", "expected_ms"),
    [
        # 60 / 2000
        ({}, BRAKES, 30.0),
        # Under a kinematic its ramps have half of it: 60 / 1000
        ({"kinematic": True}, BRAKES, 60.0),
        # P-AXIS-00024 acts with P-CHAN-00097: 60 / 500
        ({}, {**BRAKES, "getriebe[0].lslope_profil.a_feedh": 500}, 30.0),
        (
            {"use_drive_curr_limit": 1},
            {**BRAKES, "getriebe[0].lslope_profil.a_feedh": 500},
            120.0,
        ),
        # G0 that builds up: 2 x 10 ms, in which 60 grow by 4000 x 0.02 / 2; feed that brakes:
        # 100 / 2000 and (10 + 30) / 2 ms
        ({"prog_start.slope.profile": 1}, RAMPED, 20.0 + 50.0 + 20.0),
        # and with P-AXIS-00053: 100 / 500 and 10 ms
        ({"prog_start.slope.profile": 2, "use_drive_curr_limit": 1}, RAMPED, 20.0 + 200.0 + 10.0),
        # P-AXIS-00008 limits G0 to 1000: 20 ms, 60 + 10; then by feed or by G0 70 / 1000
        (
            {"prog_start.slope.profile": 1},
            {**RAMPED, "getriebe[0].dynamik.a_max": 1000},
            20.0 + 70.0 + 20.0,
        ),
    ],
)
def test_how_long_a_speed_takes_by_the_lists(
    channel: dict[str, Any], lists: Mapping[str, Any], expected_ms: float
) -> None:
    """From 60 mm/s; three NC cycles of 1 ms are on top."""
    given = dict(channel)
    kinematics = (object(),) if given.pop("kinematic", False) else ()
    made = left(set_mm=braked(2000.0), lists=lists, alarms=(alarm(30),))
    facts = replace(made.facts, channel=given, kinematics=kinematics)
    places = {"Z": (np.arange(100.0) * MS, np.array(braked(2000.0)))}
    assert stop_ns(facts, 30 * MS, places) == pytest.approx((expected_ms + 3.0) * MS)


def with_offset(a_mm_s2: float, column: str, offset_mm_s: float) -> Left:
    """Z brakes from 60 mm/s after an alarm at row 30, until which an offset moves; then it stays.

    A set position has what 3D control superposes in its row, and the offset of its own control of
    the row before.
    """
    offset_mm = [offset_mm_s * 1e-3 * min(row, 30) for row in range(100)]
    behind_mm = offset_mm if column == "superposed_mm" else [0.0, *offset_mm[:-1]]
    course = [path + more for path, more in zip(braked(a_mm_s2), behind_mm, strict=True)]
    columns = {f"Z.{column}": offset_mm}
    return left(set_mm=course, lists=BRAKES, columns=columns, alarms=(alarm(30),))


@pytest.mark.parametrize("column", ["offset_mm", "superposed_mm"])
def test_an_offset_that_goes_against_the_path_hides_no_speed_of_it(column: str) -> None:
    """60 mm/s by 2000 mm/s2 are allowed although the set position goes 2 mm/s only."""
    assert stops(with_offset(2000.0, column, -58.0)) == ""
    # two dead rows and 60 / 1.85 whole cycles, of 60 / 2 and three
    longer = stops(with_offset(1850.0, column, -58.0))
    assert longer == "34.0 ms after alarm 1, 33.0 ms allowed"


def test_one_that_goes_along_has_to_stop_with_the_path() -> None:
    """Of the set position 70 mm/s by 2000 mm/s2."""
    assert stops(with_offset(60.0 / 0.0345, "offset_mm", 10.0)) == ""
    assert stops(with_offset(60.0 / 0.0375, "offset_mm", 10.0)) != ""
