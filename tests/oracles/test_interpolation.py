"""The polynomial between two instants: exact for a cubic motion, and beside that of the plant."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from axisrig.bench.oracles.interpolation import cubic
from axisrig.kernel.cosim.plant.curves import hermite

numbers = st.floats(-100.0, 100.0)
shares, steps = st.floats(0.0, 1.0), st.floats(1e-5, 0.02)


def test_a_cubic_motion_comes_back() -> None:
    """x = 1 + 2 t + 3 t^2 + 4 t^3 from 0 to 2 s: 49 at the end with the rate 62."""
    ends = (1.0, 2.0, 49.0, 62.0)
    assert [cubic(t, 2.0, ends) for t in (0.0, 0.5, 1.0, 2.0)] == [1.0, 3.25, 10.0, 49.0]


@pytest.mark.long
@given(numbers, numbers, numbers, numbers, shares, steps)
def test_the_plant_has_derived_the_same(
    begin: float, begin_rate: float, end: float, end_rate: float, share: float, step_s: float
) -> None:
    ends = (begin, begin_rate, end, end_rate)
    size = abs(begin) + abs(end) + step_s * (abs(begin_rate) + abs(end_rate))
    ours, plants = cubic(share * step_s, step_s, ends), hermite(share * step_s, step_s, ends)
    assert ours == pytest.approx(plants, rel=0.0, abs=1e-14 * max(size, 1e-3))
