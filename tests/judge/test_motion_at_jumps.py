"""How well the motion between two SYNCs is known where its acceleration jumps at a SYNC.

A jump J at a row counts in the step before it and in the one behind it, of each the larger one of
both ends: J h^2/60 of way, J h/18 of speed. It leaves 2 J h of the step that begins with it, of
which a third of 4/27 h, and of 1, are the most that counts whatever comes after. So a step at whose
begin nothing jumps has no doubt of what jumps at its end, but for the first one, before which
nobody looked.
"""

import numpy as np
import pytest

from axisrig.bench.judge.observed.motion import motion
from axisrig.kernel.time.clock import MS

ROWS, START_MM_S2 = 9, 40.0
J = 300.0


def rows(jumps: dict[int, float], h_ms: int) -> tuple[np.ndarray, np.ndarray]:
    """Places and speeds of an acceleration that is constant between the SYNCs, mm, mm/s."""
    h_s, x, v, a = h_ms * 1e-3, [5.0], [2.0], START_MM_S2
    for row in range(ROWS - 1):
        a += jumps.get(row, 0.0)
        x.append(x[-1] + v[-1] * h_s + a * h_s**2 / 2)
        v.append(v[-1] + a * h_s)
    return np.array(x), np.array(v)


def expected(jumps: dict[int, float], ends: float, past: float) -> list[float]:
    """Of each step, J: what both ends say, and no more than what the begin leaves."""
    sizes = [abs(jumps.get(row, 0.0)) for row in range(ROWS)]
    sizes[0] = 0.0  # what was before the first row nobody knows
    return [
        min(ends * max(sizes[step : step + 2]), past * sizes[step] if step else np.inf)
        for step in range(ROWS - 1)
    ]


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("h_ms", [1, 4])
@pytest.mark.parametrize(
    "jumps",
    [
        {},
        {1: J},  # the first step ends with it
        {4: J},
        {ROWS - 2: J},  # the last step begins with it
        {4: J, 5: 3 * J},  # the later one is the larger: it counts in the step before it
        {4: 3 * J, 5: J},
        {4: J, 5: 10 * J},  # so large that the begin of the step says less
        {4: J, 5: -2 * J, 6: J},
        {1: J, 2: 2 * J, 6: 4 * J, 7: 5 * J},
    ],
)
def test_a_jump_counts_in_the_steps_on_both_sides(
    jumps: dict[int, float], h_ms: int, sign: float
) -> None:
    jumps = {row: sign * size for row, size in jumps.items()}
    h_s = h_ms * 1e-3
    x, v = rows(jumps, h_ms)
    found = motion(np.arange(ROWS, dtype=np.int64) * h_ms * MS, x, v)
    of_way = expected(jumps, 1 / 60, 4 / 27 * 2 / 3)
    of_speed = expected(jumps, 1 / 18, 2 / 3)
    assert found.doubts_mm == pytest.approx(np.array(of_way) * h_s**2, rel=1e-6, abs=1e-12)
    assert found.doubts_mm_s == pytest.approx(np.array(of_speed) * h_s, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("place", [0, 3, ROWS - 2])
def test_a_straight_step_is_known_whatever_jumps_beside_it(place: int) -> None:
    """Its way is its speed at one of its ends times its length."""
    x, v = rows({4: J}, 1)
    x[place + 1 :] += x[place] + v[place] * 1e-3 - x[place + 1]
    found = motion(np.arange(ROWS, dtype=np.int64) * MS, x, v)
    assert (found.doubts_mm[place], found.doubts_mm_s[place]) == (0.0, 0.0)
    assert found.doubts_mm.any()
