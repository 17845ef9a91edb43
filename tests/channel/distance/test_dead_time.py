"""When an offset acts: the dead time of the loop, counted from the frames on the bus."""

import struct
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from axisrig.kernel.time.clock import MS, US

OFFSET_NS = 620 * US
STEP_NS = 300 * MS + 300 * US  # between two SYNCs


def step_of(mm: float) -> Callable[[int], float]:
    return lambda time_ns: mm if time_ns >= STEP_NS else 0.0


def targets(bench: Any) -> list[tuple[int, int]]:
    """Instant and set position of every RPDO1."""
    return [
        (time_ns, struct.unpack_from("<i", data, 2)[0])
        for time_ns, can_id, data in bench.frames
        if can_id == 0x201
    ]


@pytest.mark.parametrize("buffer_cycles", [0, 5])
@pytest.mark.parametrize(("is_optimized", "later"), [(True, 0), (False, 1)])
def test_the_offset_goes_out_in_the_cycle_of_its_sensor_value_or_one_later(
    distance_bench: Callable[..., Any],
    say: Any,
    is_optimized: bool,
    later: int,
    buffer_cycles: int,
) -> None:
    """The surface moves between two SYNCs; the cycle of the next one puts the offset out.

    The buffer of set positions does not delay it.
    """
    made = distance_bench(
        step_of(0.25), is_optimized=is_optimized, options={"buffer_cycles": buffer_cycles}
    )
    made.run(say.command("on", set_pos_mm=0.0), say.dwell(400))
    first_ns = next(at for (_, before), (at, now) in pairwise(targets(made.bench)) if now != before)
    sync_ns = 301 * MS
    due_ns = sync_ns + OFFSET_NS + later * MS
    assert due_ns < first_ns < due_ns + 200 * US  # the frame itself and the queue before it


@pytest.mark.parametrize(("is_optimized", "n"), [(True, 1), (False, 2)])
@pytest.mark.parametrize("kp", [0.2, 0.5])
@pytest.mark.long(but=1)
def test_constant_distance_is_the_loop_with_that_many_dead_cycles(
    distance_bench: Callable[..., Any], say: Any, is_optimized: bool, n: int, kp: float
) -> None:
    """o(k+1) = o(k) + kp e(k-n), physics of the loop, with a step of the surface of 0.4 mm."""
    made = distance_bench(step_of(0.4), is_optimized=is_optimized, kp=kp)
    made.run(say.command("on_const", set_dist_mm=say.start_mm), say.dwell(500))
    seen, k0 = made.seen, made.seen.cycle_at(STEP_NS)
    expected = np.zeros(60)
    for k in range(59):
        # the sensor sees the offset of n cycles ago; the surface has risen by 0.4 mm
        acting = expected[k - n] if k >= n else 0.0
        expected[k + 1] = expected[k] + kp * (0.4 - acting)
    got = np.array(seen.offset_mm[k0 - 1 : k0 + 59])
    assert got == pytest.approx(expected, abs=60 * kp / say.per_mm)
