"""Whose value is in doubt in a run of several axes."""

import pytest
from tests.measuring.fake_latch import FakeLatch, Stage

from axisrig.kernel.measuring.run import RunState


@pytest.mark.parametrize(
    "doubts", [(None, 0.25), (0.5, None), (0.5, 0.25), (None, None), (0.0, 0.25)]
)
def test_every_axis_has_the_doubt_of_its_own_value(doubts: tuple[float | None, ...]) -> None:
    """0 is one, and a value that is proved has none."""
    ports = [FakeLatch(axis, doubt_mm=doubt) for axis, doubt in zip("XY", doubts, strict=True)]
    run = Stage(*ports).move()
    for port in ports:
        port.latch(1.0)
    run.cycles(2, standing=True)
    assert run.run.state is RunState.DONE
    wanted = {axis: doubt for axis, doubt in zip("XY", doubts, strict=True) if doubt is not None}
    assert run.run.record.doubt_mm == wanted
