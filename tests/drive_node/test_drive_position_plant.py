"""Stops of a drive whose plant takes position demands only."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
SYNC_NS = 48_000


@pytest.mark.parametrize(
    ("option", "word", "ramp"), [(2, 0x02, 0x6085), (6, 0x02, 0x6085), (5, 0x02, 0x6084)]
)
def test_a_plant_that_takes_positions_only_is_stopped_by_its_demand(
    drive_bench: Make, fake_axis: Any, option: int, word: int, ramp: int
) -> None:
    """From 100 mm/s with 1 m/s2: 5 mm in 100 ms, demands at each tick on the parabola."""
    axis = fake_axis()
    axis.kinds = frozenset({ControlKind.POSITION})
    bench = drive_bench(axis)
    bench.remote.sdo[0x605A].raw = option
    bench.remote.sdo[ramp].raw = 104_857_600
    bench.operational(3)
    bench.enable(4)
    for n in range(1, 21):
        bench.set_values(0x0F, round(n * 10_485.76))
        bench.sync_at_ms(6 + n)
    bench.set_values(word, 0)
    bench.sync_at_ms(27)
    begin = next(c for c in axis.commands if c.time_ns == 27 * MS + SYNC_NS)
    assert begin.position_m == pytest.approx(0.002, abs=1e-8)
    v_m_s = axis.commands[axis.commands.index(begin) - 1].velocity_m_s  # a whole unit per ms
    for time_ms in (30.25, 75.0, 99.5):
        now_ns = 27 * MS + SYNC_NS + round(time_ms * MS)
        bench.scheduler.run_until(now_ns)
        axis.advance_to(now_ns)
        t = time_ms * 1e-3
        expected = begin.position_m + v_m_s * t - t * t / 2
        assert axis.demand_position_m() == pytest.approx(expected, abs=1e-8)
        assert axis.commands[-1].enabled
    bench.run_to_ms(140)
    axis.advance_to(140 * MS)
    assert axis.demand_position_m() == pytest.approx(begin.position_m + v_m_s**2 / 2, abs=1e-8)
    assert axis.commands[-1].enabled == (option > 4)


def test_a_following_error_of_such_a_plant_stops_from_where_the_axis_is(
    drive_bench: Make, fake_axis: Any
) -> None:
    """Stuck at 0 with the demand 1 mm ahead: the demand goes back to the axis, not on."""
    axis = fake_axis(motion=lambda t: 0.0)
    axis.kinds = frozenset({ControlKind.POSITION})
    bench = drive_bench(axis)
    bench.remote.sdo[0x6065].raw = 100_000
    bench.operational()
    bench.enable(3)
    for n in range(1, 20):
        bench.set_values(0x0F, n * 10_486)
        bench.sync_at_ms(5 + n)
        if bench.node.state is not State.OPERATION_ENABLED:
            break
    assert bench.node.state in (State.FAULT_REACTION_ACTIVE, State.FAULT)
    faulted = [c for c in axis.commands if c.position_m == 0.0 and c.time_ns > 14 * MS]
    assert faulted
    assert max(c.position_m for c in axis.commands) < 1e-3
