"""Where the answer of a path to a pulse ends for who tunes a loop."""

import numpy as np
import pytest

from axisrig.bench.tools.tune.loop import trimmed


@pytest.mark.parametrize(
    ("pulses", "kept"),
    [([1.0, 0.0, 0.0], 1), ([0.0, -1.0, 1e-12], 2), ([0.0, 1.0, -1.1e-12], 3), ([0.0, 0.0], 1),
     ([1.0, 0.0, 2.0], 3)],
)  # fmt: skip
def test_the_end_that_nobody_can_see_is_left_out(pulses: list[float], kept: int) -> None:
    """Up to 1e-12 of it, in either direction; what is nothing at all keeps one value."""
    assert list(trimmed(np.array(pulses))) == pulses[:kept]
