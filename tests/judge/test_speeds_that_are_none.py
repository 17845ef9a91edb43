"""Speeds and doubts near nothing: a surface that creeps, an axis at rest, doubts that are small.

Rows each millisecond; 0.2 nm from row to row are no motion of a surface.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import truth_of_steps
from tests.judge.test_touches import BETWEEN_UM, RUN, recorded, seen

from axisrig.bench.judge.distance.control_stretches import steady
from axisrig.bench.oracles.errors import NoClosedFormError

# Surfaces


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("step_mm", "speed_mm_s"),
    [(0.0, 0.0), (1e-7, 0.0), (1.9e-7, 0.0), (2.1e-7, 2.1e-4), (1e-3, 1.0)],
)
def test_a_surface_that_moves_by_less_than_a_rounding_is_at_rest(
    sign: int, step_mm: float, speed_mm_s: float
) -> None:
    """Its speed is 0 then and not a little: what follows from it has no lag."""
    part, found = steady(truth_of_steps(np.full(60, sign * step_mm)))
    assert part.end - part.begin >= 58
    if speed_mm_s:
        assert found == pytest.approx(sign * speed_mm_s)
    else:
        assert found == 0.0


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("at", [0, 30, 59])
def test_the_speed_of_a_surface_is_that_of_most_of_its_rows(sign: int, at: int) -> None:
    """One row is 0.15 nm off, which is even still: 10 mm/s, not 10.00015."""
    steps_mm = np.full(60, sign * 0.01)
    steps_mm[at] += 1.5e-7
    part, found = steady(truth_of_steps(steps_mm))
    assert part.end - part.begin >= 58
    assert found == pytest.approx(sign * 10.0, rel=1e-9)


def test_where_the_surface_never_moves_evenly_there_is_no_speed() -> None:
    uneven = np.cumsum(np.arange(60.0)) * 1e-4
    with pytest.raises(NoClosedFormError, match="never at rest and never rose evenly"):
        steady(truth_of_steps(uneven))


@pytest.mark.parametrize(("count", "is_enough"), [(9, False), (10, False), (11, True), (12, True)])
def test_ten_rows_are_enough(count: int, is_enough: bool) -> None:
    """Of 0.01 mm each, between steps that are no two alike; the first is none yet."""
    odd = [0.3, 0.1, 0.5, 0.2]
    truth = truth_of_steps(np.array([*odd, *[0.01] * count, *odd[::-1]]))
    if is_enough:
        part, _ = steady(truth)
        assert part.end - part.begin >= 10
    else:
        with pytest.raises(NoClosedFormError):
            steady(truth)


# Touches


@pytest.mark.parametrize(
    ("speed_mm_s", "is_signed"), [(-10.0, True), (-1e-6, True), (0.0, False), (10.0, False)]
)
def test_a_speed_is_signed_where_it_is_towards_smaller_positions(
    speed_mm_s: float, is_signed: bool
) -> None:
    """An axis that rests at the contact goes nowhere."""
    times = np.arange(40.0) * 1e-3
    columns: Any = {
        "Z.truth_mm": 100.0 + speed_mm_s * times, "Z.velocity_mm_s": np.full(40, speed_mm_s),
    }  # fmt: skip
    found = seen(recorded(columns=columns), "contact_velocity_mm_s:Z")
    assert found.value == pytest.approx(speed_mm_s, rel=1e-4)
    assert ("towards smaller positions" in found.note) is is_signed


@pytest.mark.parametrize("doubt_mm", [None, 0.0, 1e-5, 0.002])
def test_the_doubt_of_a_latch_comes_on_top_of_what_events_and_interpolation_leave(
    doubt_mm: float | None,
) -> None:
    """10 mm/s for 2 ns are 0.02 nm, a fine step leaves 0.04 nm; a doubt adds to both."""
    run = RUN if doubt_mm is None else replace(RUN, doubt_mm={"Z": doubt_mm})
    found = seen(recorded(run), "latch_error_um:Z")
    plain_um = 10.0e3 * 2e-9 + BETWEEN_UM
    assert found.value == pytest.approx(0.5)
    assert found.uncertainty == pytest.approx(plain_um + 1e3 * (doubt_mm or 0.0), rel=1e-3)
