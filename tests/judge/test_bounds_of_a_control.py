"""How long a part of a control must be, and from which row on its steps are free of limits."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import ROWS, K, no_value, recorded, seen, truth_of_steps

from axisrig.bench.judge.distance.control_stretches import steady, unknown_poles
from axisrig.bench.oracles.distance.loop import CONST_DIST, SET_POS
from axisrig.bench.oracles.errors import NoClosedFormError

SURFACE = np.where(K < 300, 0.0, 1.0)
"""It steps at row 300."""


def restless(even: int, step_mm: float = 0.0) -> Any:
    """Even steps after ones that all differ."""
    return truth_of_steps([*(0.1 * (n % 3) for n in range(30)), 0.5, *([step_mm] * even)])


@pytest.mark.parametrize(("count", "is_there"), [(10, False), (11, True), (40, True)])
def test_a_surface_is_even_where_its_steps_are_so_for_ten_cycles(
    count: int, is_there: bool
) -> None:
    """Of the first step it is not known whether it is like the one before."""
    if not is_there:
        with pytest.raises(NoClosedFormError, match="never at rest and never rose evenly"):
            steady(restless(count))
        return
    part, speed_mm_s = steady(restless(count))
    assert (part.end - part.begin, speed_mm_s) == (count - 1, 0.0)
    assert part.end == 31 + count + 1


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("moves", "speed_mm_s"), [(21, 10.0), (20, 0.0)])
def test_a_surface_that_moves_for_twenty_cycles_counts_before_one_at_rest(
    moves: int, speed_mm_s: float, sign: float
) -> None:
    """0.01 mm in a cycle of 1 ms, after a rest of 100; fewer cycles show no motion."""
    steps = [*([0.0] * 100), 0.3, *([sign * 0.01] * moves)]
    _, found = steady(truth_of_steps(steps))
    assert found == pytest.approx(sign * speed_mm_s)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("factor", [0.9, 0.95])
def test_steps_are_free_from_the_row_after_the_last_one_that_a_limit_held(
    factor: float, sign: float
) -> None:
    """0.05 mm a cycle for 40 cycles after the step of the surface, then each is a share of it."""
    last = 340
    free = 0.04 * factor ** np.maximum(K - last - 1.0, 0.0)
    step = np.where(K > 300, np.where(last >= K, 0.05, free), 0.0)
    delta = np.where((K > 300) & (last >= K), 0.5, step)
    columns = {"step_mm": sign * step, "delta_mm": sign * delta}
    found = seen(recorded(0.0, SURFACE, columns=columns), "distance_growth")
    assert found.value == pytest.approx(factor, abs=1e-6)
    rest = {"step_mm": np.where(last >= K, step, 0.0), "delta_mm": np.where(last >= K, delta, 0.0)}
    after = seen(recorded(0.0, SURFACE, columns=rest), "distance_growth")
    assert (after.value, after.note) == (
        0.0, f"at rest {ROWS - last - 1} cycles after the limits acted"
    )  # fmt: skip


def test_what_nothing_has_moved_shows_no_growth() -> None:
    assert no_value(recorded(), "distance_growth").startswith("nothing moved")


@pytest.mark.parametrize(
    ("mode", "age", "kv", "every", "words"),
    [
        (SET_POS, 0, 0.0, 1, ""),
        (SET_POS, 0, 50.0, 1, ""),
        (SET_POS, 1, 50.0, 1, "the loops of the drive are part of it"),
        (SET_POS, -1, 50.0, 1, "the loops of the drive are part of it"),
        (SET_POS, 1, 0.0, 1, ""),
        (CONST_DIST, 0, 50.0, 1, "the loops of the drive are part of it"),
        (CONST_DIST, 0, 0.0, 1, ""),
        (CONST_DIST, 0, None, 1, ""),
        (CONST_DIST, 0, 0.0, 2, "60E4 does not come with every SYNC"),
        (SET_POS, 0, 50.0, 3, "60E4 does not come with every SYNC"),
    ],
)
def test_poles_are_not_known_where_the_loops_of_a_drive_are_in_the_loop(
    mode: str, age: int, kv: float | None, every: int, words: str
) -> None:
    """A drive that is a lag alone has no kv; SET_POS sees it with a sensor of another age."""
    values = None if kv is None else {"kv": kv}
    truth: Any = SimpleNamespace(every=every, values=values, sensor_age_cycles=age)
    assert unknown_poles(truth, mode) == words
