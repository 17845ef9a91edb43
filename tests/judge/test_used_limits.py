"""How much of each limit of a distance control was used, as the report shows it."""

from typing import Any

import numpy as np
import pytest
from tests.judge.controls import ON, ROWS, K, recorded

from axisrig.bench.judge.distance.findings import control_findings
from axisrig.bench.judge.distance.truth import ACTIVE_CONST_DIST, INACTIVE, TURNING_OFF
from axisrig.bench.record.distance import Controller, DistanceChange
from axisrig.kernel.time.clock import MS

CONTROLLER = Controller(0.2, 0.0, 0.0, "DEFAULT", 1, 0.7, 4, 25.0, 0.1, False)


def used(behind_mm: Any = 0.0, **columns: Any) -> dict[str, float | None]:
    on = DistanceChange(ON * MS, "ACTIVE_CONST_DIST", "NC", "60E4", False, CONTROLLER)
    (found,) = control_findings(recorded(behind_mm, columns=columns, changes=(on,)))
    return {limit.key: limit.used for limit in found.limits}


def from_row(*values: tuple[int, float]) -> Any:
    course = np.zeros(ROWS)
    for row, value in values:
        course[row:] = value
    return course


def test_a_sensor_value_has_its_ends_with_their_signs() -> None:
    """2 mm of distance: the value is -2; 0.5 mm nearer is -1.5, 0.25 mm farther -2.25."""
    found = used(from_row((50, 9.0), (ON, 0.0), (300, 0.5), (500, -0.25), (700, 0.0)))
    assert (found["max_pos"], found["min_pos"]) == (pytest.approx(-1.5), pytest.approx(-2.25))
    # A jump of 0.75 mm in a cycle of 1 ms; that in the first row of the control is none
    assert found["max_act_value_change"] == pytest.approx(750.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_offset_uses_its_limits_in_both_directions(sign: float) -> None:
    """Up by 0.3 and 0.4 mm, down by 0.6: 600 mm/s; from +400 to 0 and to -600 in cycles."""
    found = used(offset_mm=sign * from_row((300, 0.3), (301, 0.7), (500, 0.1)))
    assert found["max_deviation"] == pytest.approx(0.7)
    assert found["v_max"] == pytest.approx(600.0)
    assert found["a_max"] == pytest.approx(600e3)


@pytest.mark.parametrize(
    ("before", "v_mm_s"), [(ACTIVE_CONST_DIST, 0.0), (TURNING_OFF, 500.0), (INACTIVE, 0.0)]
)
def test_what_is_handed_over_at_once_is_no_motion(before: int, v_mm_s: float) -> None:
    """0.5 mm are gone in the row that is off: by NO_MOVE, or as the last step on the way to 0."""
    state = np.where(K < ON, float(INACTIVE), float(ACTIVE_CONST_DIST))
    state[499:], state[500:] = before, INACTIVE
    offset = np.full(ROWS, 0.5)
    offset[500:] = 0.0
    assert used(offset_mm=offset, distance_state=state)["v_max"] == pytest.approx(v_mm_s)


@pytest.mark.parametrize(
    ("row", "v_mm_s", "a_mm_s2"),
    [(450, 250.0, 250e3), (499, 250.0, 250e3), (500, 250.0, 0.0), (505, 250.0, 0.0),
     (510, 250.0, 0.0), (511, 0.0, 0.0)],
)  # fmt: skip
def test_a_step_has_its_acceleration_while_the_control_is_on(
    row: int, v_mm_s: float, a_mm_s2: float
) -> None:
    """It runs out in rows 500 to 509, and the row after them still moves: with a speed alone."""
    state = np.where(K < ON, float(INACTIVE), float(ACTIVE_CONST_DIST))
    state[500:510], state[510:] = TURNING_OFF, INACTIVE
    found = used(offset_mm=from_row((row, -0.25)), distance_state=state)
    assert (found["v_max"], found["a_max"]) == (pytest.approx(v_mm_s), pytest.approx(a_mm_s2))
    assert found["max_deviation"] == 0.25


@pytest.mark.parametrize(("is_rotary", "length"), [(False, "mm"), (True, "°")])
def test_limits_of_an_axis_that_turns_are_angles(is_rotary: bool, length: str) -> None:
    on = DistanceChange(ON * MS, "ACTIVE_CONST_DIST", "NC", "60E4", False, CONTROLLER)
    words = {"ref_offset": -2500}
    observed = recorded(changes=(on,), is_rotary=is_rotary, words=words)
    (found,) = control_findings(observed)
    assert found.unit == length
    assert {limit.key: limit.unit for limit in found.limits} == {
        "v_max": f"{length}/s", "a_max": f"{length}/s²", "max_deviation": length,
        "max_act_value_change": f"{length}/s", "max_pos": length, "min_pos": length,
    }  # fmt: skip
    assert list(found.notes) == [f"The sensor value is 0 at a gap of 0.25 {length} (ref_offset)."]


def test_the_row_that_switches_on_has_no_value_of_the_control_yet() -> None:
    """9 mm nearer until that row: neither an end, nor a jump in the row after it."""
    found = used(from_row((50, 9.0), (ON + 1, 0.0), (ON + 2, 0.25)))
    assert (found["max_pos"], found["min_pos"]) == (pytest.approx(-1.75), pytest.approx(-2.0))
    assert found["max_act_value_change"] == pytest.approx(250.0)
    early = used(offset_mm=from_row((ON, 0.4), (ON + 2, 0.5)))
    assert early["a_max"] == pytest.approx(400e3)  # 400 mm/s are gone in the row after it
