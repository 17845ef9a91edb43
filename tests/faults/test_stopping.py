"""How long set positions may go on after an alarm, from lists and speed."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.faults.made_runs import BRAKES, LISTS, alarm, braked, left

from axisrig.bench.tools.scenarios.invariants import stops
from axisrig.bench.tools.scenarios.left import Left
from axisrig.bench.tools.scenarios.stopping import Braking, brakings, stop_ns
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


def gear(**values: float) -> dict[str, Any]:
    """Values of the gear of an axis; __ stands for the dot."""
    return {f"getriebe[0].{name.replace('__', '.')}": value for name, value in values.items()}


PROFILE = gear(
    slope_profil__a_beschl=1100, slope_profil__a_brems=2100, slope_profil__a_grenz=4100,
    slope_profil__a_feedh=510, slope_profil__tr_beschl_zu=11_000,
    slope_profil__tr_beschl_ab=17_000, slope_profil__tr_brems_zu=23_000,
    slope_profil__tr_brems_ab=31_000, slope_profil__tr_grenz=7000, slope_profil__tr_feedh=3000,
)  # fmt: skip


@pytest.mark.parametrize(
    ("lists", "downs", "ups"),
    [
        # Ramps of no list are 50 ms, those of G0 10 ms, accelerations 1000; least time 10 ms
        ({}, [(1000, 0.05), (1000, 0.01)], [(1000, 0.1), (1000, 0.02)]),
        (PROFILE, [(2100, 0.027), (4100, 0.01), (510, 0.01)], [(1100, 0.028), (4100, 0.02)]),
        (PROFILE | gear(dynamik__tr_min=1000), [(2100, 0.027), (4100, 0.007), (510, 0.003)],
         [(1100, 0.028), (4100, 0.014)]),
        (PROFILE | gear(dynamik__tr_min=20_000), [(2100, 0.027), (4100, 0.02), (510, 0.02)],
         [(1100, 0.04), (4100, 0.04)]),
        # Without a time of its own a feedhold has that of G0
        (PROFILE | gear(dynamik__tr_min=0, slope_profil__tr_feedh=0),
         [(2100, 0.027), (4100, 0.007), (510, 0.007)], [(1100, 0.028), (4100, 0.014)]),
        (PROFILE | gear(dynamik__a_max=500, slope_profil__a_feedh=0),
         [(500, 0.027), (500, 0.01)], [(500, 0.028), (500, 0.02)]),
    ],
)  # fmt: skip
def test_with_ramps_each_deceleration_may_come_while_each_acceleration_acts(
    lists: dict[str, Any], downs: list[tuple[float, float]], ups: list[tuple[float, float]]
) -> None:
    """P-AXIS-00001 to 00004, 00053 with their ramp times, none shorter than P-AXIS-00201."""
    channel = {"prog_start.slope.profile": 1, "use_drive_curr_limit": 1}
    found = [way for way in brakings(lists, channel) if way.up_s]
    expected = [(*down, *up) for down in downs for up in ups]
    assert len(found) == len(expected)
    for way, parts in zip(found, expected, strict=True):
        assert (way.a_mm_s2, way.ramps_s, way.up_mm_s2, way.up_s) == pytest.approx(parts)


def test_without_ramps_an_axis_brakes_by_its_steps_or_as_it_is_taken_off_the_path() -> None:
    """P-AXIS-00003 before P-AXIS-00008; a deceleration of a step before its acceleration."""
    steps = gear(lslope_profil__a_stufe_1=100, lslope_profil__d_stufe_1=110,
                 lslope_profil__a_stufe_2=200, lslope_profil__d_grenz_stufe_1=310,
                 lslope_profil__a_grenz_stufe_1=300, lslope_profil__a_feedh=55)  # fmt: skip
    of_steps = [110, 200, 310, 1000]
    hold = {"use_drive_curr_limit": 1}
    for lists, channel, found in (
        (steps, {}, of_steps), (steps, hold, [*of_steps, 55]), ({}, hold, [1000] * 4),
        (steps | gear(dynamik__a_max=900), {}, [900, *of_steps]),
        (steps | gear(dynamik__a_max=900, dynamik__a_emergency=950), {}, [950, *of_steps]),
    ):  # fmt: skip
        assert list(brakings(lists, channel)) == [Braking(float(a)) for a in found]


def test_the_axis_that_takes_longest_decides_by_its_speed_at_the_alarm() -> None:
    """X: 20 mm/s by 100, Z: 60 by 1000 mm/s2; the cycles beside the alarm count, 5 are dead."""
    times_ns = np.arange(40.0) * MS
    x_mm = np.minimum(np.arange(40.0), 30.0) * 0.02
    z_mm = np.where(np.arange(40) < 10, np.arange(40.0) * 5.0, 45.0 + np.arange(40.0) * 0.06)
    made = left(alarms=(alarm(30),))
    slow = gear(**{f"lslope_profil__a_{step}": 100 for step in
                   ("stufe_1", "stufe_2", "grenz_stufe_1", "grenz_stufe_2")})  # fmt: skip
    z = replace(made.facts.axes["Z"], written={})
    timing = replace(made.facts.timing, buffer_cycles=2)
    facts = replace(
        made.facts, axes={"X": replace(z, written=slow), "Z": z}, channel={}, timing=timing
    )
    places = {"X": (times_ns, x_mm), "Z": (times_ns, z_mm)}
    for alarm_ms, longest_ms in ((30, 200.0), (31, 60.0), (20, 200.0), (9, 5000.0)):
        found = stop_ns(facts, alarm_ms * MS, places)
        assert found == pytest.approx((longest_ms + 5.0) * MS), alarm_ms
    only_z = stop_ns(facts, 20 * MS, {"Z": places["Z"]})
    assert only_z == pytest.approx((60.0 + 5.0) * MS)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("alarm_ms", "speed_mm_s"),
    [
        (18.5, 0.0),
        (19.0, 60.0),
        (19.5, 60.0),
        (20.0, 60.0),
        (20.5, 60.0),
        (21.0, 60.0),
        (22.0, 0.0),
    ],
)
def test_the_faster_one_of_the_steps_before_and_after_an_alarm_counts(
    alarm_ms: float, speed_mm_s: float, side: float
) -> None:
    """One step of 0.06 mm, from row 19 to row 20 and again to row 21; 60 mm/s by 1000 mm/s2."""
    places = side * np.clip((np.arange(40.0) - 19.0) * 0.06, 0.0, 0.12)
    made = left(alarms=(alarm(20),))
    axis = replace(made.facts.axes["Z"], written={})
    facts = replace(made.facts, axes={"Z": axis}, channel={})
    took = stop_ns(facts, round(alarm_ms * MS), {"Z": (np.arange(40.0) * MS, places)})
    assert took == pytest.approx((speed_mm_s + 3.0) * MS)


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
