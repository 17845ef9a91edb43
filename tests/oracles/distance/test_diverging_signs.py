"""Wrong signs of distance control over a level surface, cycle by cycle in closed form.

kp = 1, no limits, and what is sent is reached two cycles later. The tool is at the height h and
aims at d; a sensor of the wrong sign gives +h where -h is right. With the offset o of the cycle:

    CONST_DIST  e = d + h + o(k-2)              o / (d + h)  = 1, 2, 4, 7, 12, 20
    SET_POS     e = 2 (h + o(k-2)) - d - o(k-1)  o / (2h - d) = 1, 1, 3, 3, 7, 7, 15
    BOTH        e = d + h + 2 o(k-2) - o(k-1)    o / (d + h)  = 1, 1, 3, 3, 7, 7, 15

The sensor gives h + o(k-2) in the cycle k.
"""

import math

import pytest

from axisrig.bench.oracles.distance.lists import Control, Limits
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS
from axisrig.bench.oracles.distance.model import Law, Rig
from axisrig.bench.oracles.distance.signs import TABLE, Signs, predicted
from axisrig.bench.oracles.distance.supervision import ABOVE, BELOW, JUMP, OFFSET, Due

PERIOD_NS = 1_000_000
GAP_MM, SET_MM = 1.5, 1.0
GROWTH = {
    CONST_DIST: (SET_MM + GAP_MM, (1, 2, 4, 7, 12, 20)),
    SET_POS: (2 * GAP_MM - SET_MM, (1, 1, 3, 3, 7, 7, 15)),
    BOTH: (SET_MM + GAP_MM, (1, 1, 3, 3, 7, 7, 15)),
}
FAR = math.inf
WRONG = [signs for signs in TABLE if signs.inverts != signs.tells_gap]
RIGHT = [signs for signs in TABLE if signs.inverts == signs.tells_gap]


def due(
    signs: Signs,
    low_mm: float = -FAR,
    high_mm: float = FAR,
    deviation_mm: float = FAR,
    change_mm_s: float = FAR,
    **more: float,
) -> Due | None:
    limits = Limits(FAR, FAR, deviation_mm, change_mm_s, low_mm, high_mm)
    law = Law(signs.mode, Control(1.0), PERIOD_NS, limits)
    at = {"gap_mm": GAP_MM, "set_mm": SET_MM, "cycles": 12, **more}
    return predicted(signs, law, Rig(), at["gap_mm"], at["set_mm"], int(at["cycles"]))


def offsets_mm(mode: str) -> list[float]:
    unit_mm, shares = GROWTH[mode]
    return [unit_mm * share for share in shares]


@pytest.mark.parametrize("signs", WRONG, ids=str)
def test_an_offset_of_the_wrong_sign_is_at_its_limit_in_the_cycle_that_passes_it(
    signs: Signs,
) -> None:
    """Just below an offset it is the first cycle with it, at it a later one."""
    found = offsets_mm(signs.mode)
    for row, offset_mm in enumerate(found):
        first = found.index(offset_mm)
        assert due(signs, deviation_mm=offset_mm - 1e-6) == Due(OFFSET, first)
        later = next((k for k, each in enumerate(found) if each > offset_mm), None)
        if later is not None:
            assert row < later
            assert due(signs, deviation_mm=offset_mm) == Due(OFFSET, later)


@pytest.mark.parametrize("signs", WRONG, ids=str)
def test_a_sensor_of_the_wrong_sign_gives_the_height_of_the_tool_from_the_first_cycle_on(
    signs: Signs,
) -> None:
    """The height, and not the distance that it aims at; it rises two cycles after the offset."""
    assert due(signs, high_mm=GAP_MM - 1e-6) == Due(ABOVE, 0)
    given = [GAP_MM + offset_mm for offset_mm in offsets_mm(signs.mode)]
    for row, value_mm in enumerate(given):
        assert due(signs, high_mm=value_mm - 1e-6) == Due(ABOVE, given.index(value_mm) + 2)
        later = next((k for k, each in enumerate(given) if each > value_mm), None)
        if later is not None:
            assert row < later
            assert due(signs, high_mm=value_mm) == Due(ABOVE, later + 2)


@pytest.mark.parametrize("signs", WRONG, ids=str)
def test_a_sensor_value_jumps_when_the_first_offset_is_reached(signs: Signs) -> None:
    """By that offset in one cycle of 1 ms; as fast as its limit it may."""
    first_mm = offsets_mm(signs.mode)[0]
    assert due(signs, change_mm_s=first_mm * 1e3 - 1e-3) == Due(JUMP, 2)
    found = due(signs, change_mm_s=first_mm * 1e3)
    assert found is not None
    assert found.row > 2


@pytest.mark.parametrize("signs", WRONG, ids=str)
@pytest.mark.parametrize(("gap_mm", "set_mm"), [(3.0, -3.0), (-3.0, 3.0)])
def test_a_tool_that_is_where_the_wrong_sign_wants_it_stays(
    signs: Signs, gap_mm: float, set_mm: float
) -> None:
    """d = -h is no error for a distance; a set position d is 3 h away from it."""
    limits = {"low_mm": -4.0, "high_mm": 4.0}
    found = due(signs, gap_mm=gap_mm, set_mm=set_mm, **limits)
    if signs.mode != SET_POS:
        assert found is None
        return
    assert found == Due(ABOVE if gap_mm > 0 else BELOW, 2)


@pytest.mark.parametrize("signs", TABLE, ids=str)
@pytest.mark.parametrize("gap_mm", [6.0, -6.0])
def test_a_tool_that_begins_outside_the_sensor_is_an_alarm_of_the_first_cycle(
    signs: Signs, gap_mm: float
) -> None:
    """A right sign makes the sensor value smaller the higher the tool is."""
    is_above = (gap_mm > 0) is (signs in WRONG)
    found = due(signs, gap_mm=gap_mm, set_mm=0.5, low_mm=-5.0, high_mm=5.0)
    assert found == Due(ABOVE if is_above else BELOW, 0)
    at_limit = due(signs, gap_mm=gap_mm, set_mm=0.5, low_mm=-6.0, high_mm=6.0, cycles=1)
    assert at_limit is None


@pytest.mark.parametrize("signs", WRONG, ids=str)
def test_what_comes_after_the_last_cycle_is_not_predicted(signs: Signs) -> None:
    limit_mm = offsets_mm(signs.mode)[2] - 1e-6
    assert due(signs, deviation_mm=limit_mm, cycles=2) is None
    assert due(signs, deviation_mm=limit_mm, cycles=3) == Due(OFFSET, 2)


@pytest.mark.parametrize("signs", RIGHT, ids=str)
def test_a_documented_sign_at_its_distance_has_nothing_to_do(signs: Signs) -> None:
    """The set position of a level surface at 0 is the height itself."""
    limits = {"low_mm": -3.0, "high_mm": 3.0, "deviation_mm": 1e-6, "change_mm_s": 1e-3}
    set_mm = 0.0 if signs.mode == SET_POS else 2.0
    assert due(signs, gap_mm=2.0, set_mm=set_mm, **limits) is None
    first = due(signs, gap_mm=2.0, set_mm=set_mm + 0.5, **limits)
    assert first == Due(OFFSET, 0)


@pytest.mark.parametrize(
    ("inverts", "tells_gap", "converges"),
    [(True, True, True), (False, False, True), (True, False, False), (False, True, False)],
)
@pytest.mark.parametrize("mode", [SET_POS, CONST_DIST, BOTH])
def test_a_sensor_with_the_motor_needs_the_inversion_and_one_against_it_none(
    mode: str, inverts: bool, tells_gap: bool, converges: bool
) -> None:
    """FCT-M3 5, P-AXIS-00230: in each mode."""
    signs = Signs(mode, inverts, tells_gap)
    assert TABLE.count(signs) == 1
    assert (signs.converges, signs.sign) == (converges, 1 if converges else -1)
