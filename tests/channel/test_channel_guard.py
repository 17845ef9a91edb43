"""Set positions that pass what an axis may do: an alarm before they are sent, its own ramp after.

What leads an axis wrongly is put in by the test: `Path.leaders`, where couplings put their slaves.
"""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest
from tests.channel.conftest import ChannelBench

from axisrig.kernel.channel.path.settings import AxisSettings
from axisrig.kernel.channel.state import ChannelState
from axisrig.kernel.motion.profile import Slope

Make = Callable[..., ChannelBench]
T = 1e-3
INCREMENT_MM = 10.0 / 2**20
EMERGENCY_MM_S2 = 800.0


def emergency(settings: AxisSettings) -> AxisSettings:
    """P-AXIS-00003."""
    return replace(settings, emergency=Slope(EMERGENCY_MM_S2, EMERGENCY_MM_S2, 1.0))


def steps_mm(bench: ChannelBench, axis: str) -> list[float]:
    index = list(bench.axes).index(axis)
    sent = [sample.sent_mm[index] for sample in bench.samples if sample.power]
    return [b - a for a, b in pairwise(sent)]


def lead_wrongly(bench: ChannelBench, beyond_mm: dict[str, float], *, grows: bool = False) -> None:
    """Put axes beside where they belong, from 10 mm of Z on; by more from cycle to cycle."""
    channel, path = bench.channel, bench.channel.path
    cycles = 0

    def follow() -> None:
        nonlocal cycles
        if channel.state is not ChannelState.RUNNING or path.position_acs_mm("Z") <= 10.0:
            return
        cycles += 1
        share = cycles * cycles if grows else 1
        for axis, mm in beyond_mm.items():
            path.put_off_path(axis, path.position_acs_mm(axis) + share * mm)

    path.leaders.append(follow)


@pytest.mark.provokes(
    900500, 7, axis="Z", what="Z 60 mm/s, 20000 mm/s2 with 500 mm/s and 1000 mm/s2 allowed"
)
@pytest.mark.parametrize("buffer_cycles", [0, 3])
def test_a_jump_is_not_sent_and_its_axis_brakes_from_the_last_legal_position(
    channel_bench: Make, words: Any, buffer_cycles: int
) -> None:
    """0.02 mm beside the path is 20 000 mm/s2; Z brakes from 40 mm/s on v²/2a, Y on the path."""
    axes = words.axis("Y"), words.axis("Z")
    bench = channel_bench(*axes, buffer_cycles=buffer_cycles)
    bench.channel.path.use(emergency(bench.channel.path.settings("Z")))
    lead_wrongly(bench, {"Z": 0.02})
    bench.run([words.move(1, 3000.0, Y=60.0, Z=80.0), words.end()])
    assert bench.alarm_ids == [900500]
    assert bench.channel.alarms[0].values["axis"] == "Z"
    for axis in ("Y", "Z"):
        steps = steps_mm(bench, axis)
        assert max(map(abs, steps)) <= 0.04 + INCREMENT_MM
        assert max(abs(b - a) for a, b in pairwise(steps)) <= 1000.0 * T * T + 2 * INCREMENT_MM
    way_mm = 40.0**2 / (2.0 * EMERGENCY_MM_S2)
    last_legal_mm = bench.final_mm("Z") - way_mm
    assert 10.0 - 0.04 < last_legal_mm <= 10.0 + 0.04


@pytest.mark.long
def test_two_axes_that_jump_in_one_cycle_both_brake_by_themselves(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    lead_wrongly(bench, {"Y": -0.02, "Z": 0.02})
    bench.run([words.move(1, 3000.0, Y=60.0, Z=80.0), words.end()])
    assert bench.channel.alarms[0].values["axis"] == "Y Z"
    for axis in ("Y", "Z"):
        steps = steps_mm(bench, axis)
        assert max(abs(b - a) for a, b in pairwise(steps)) <= 1000.0 * T * T + 2 * INCREMENT_MM


@pytest.mark.long
def test_an_axis_faster_than_p_axis_00212_is_stopped(channel_bench: Make, words: Any) -> None:
    """A creeping 0.0008 mm more in each cycle is no jump, but 500 mm/s are passed."""
    bench = channel_bench(words.axis("Z"))
    lead_wrongly(bench, {"Z": 0.0004}, grows=True)
    bench.run([words.move(1, 3000.0, Z=900.0), words.end()])
    assert bench.alarm_ids == [900500]
    assert max(steps_mm(bench, "Z")) <= 0.5 + INCREMENT_MM
    assert max(steps_mm(bench, "Z")) > 0.49


def test_the_limits_of_set_points_are_those_of_every_profile_and_of_the_own_stop(
    words: Any,
) -> None:
    """Linear 1000 mm/s2, one profile with ramps 1500, the emergency stop 800 or 4000."""
    axis = words.axis("Z", a_mm_s2=1000.0).settings()
    ramped = words.axis("Z", a_mm_s2=1500.0).settings().jerk_limited
    for shape in ramped:
        of_one = replace(axis, jerk_limited={**axis.jerk_limited, shape: ramped[shape]})
        assert emergency(of_one).of_set_points(100.0).a_mm_s2 == 1500.0
    hard = replace(axis, emergency=Slope(4000.0, 4000.0, 1.0))
    found = hard.of_set_points(100.0)
    assert (found.a_mm_s2, found.speed_mm_s, found.increment_mm) == (4000.0, 500.0, 0.01)
