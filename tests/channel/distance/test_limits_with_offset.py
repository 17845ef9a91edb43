"""Whether the offset counts for the software limit switches (P-AXIS-00428)."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.channel.path.soft_limits import SoftLimits
from axisrig.kernel.time.clock import MS

Make = Callable[..., Any]
LIMITS = SoftLimits(negative_mm=0.0, positive_mm=12.0, tolerance_mm=0.1)


def made_with(distance_bench: Make, *, counts: bool, height_mm: float) -> Any:
    return distance_bench(
        lambda time_ns: height_mm if time_ns > 100 * MS else 0.0,
        spec={"limits": LIMITS}, checks_limits=counts, v_max_mm_s=20.0, kp=0.2,
    )  # fmt: skip


@pytest.mark.provokes(70021, 7, axis="Z")
def test_counted_it_stops_the_axis_at_the_switch(distance_bench: Make, say: Any) -> None:
    """From 10 mm with an offset of 3 mm over a switch at 12 mm, tolerance 0.1 mm."""
    made = made_with(distance_bench, counts=True, height_mm=3.0)
    made.run(say.command("on", set_pos_mm=0.0), say.dwell(600))
    assert made.alarm_ids == [70021]
    assert 12.1 < made.seen.actual_mm[-1] < 12.1 + 5 * 20e-3


@pytest.mark.long
def test_not_counted_it_does_not(distance_bench: Make, say: Any) -> None:
    made = made_with(distance_bench, counts=False, height_mm=3.0)
    made.run(say.command("on", set_pos_mm=0.0), say.dwell(600), say.command("off"))
    assert made.alarm_ids == []
    assert max(made.seen.actual_mm) == pytest.approx(13.0, abs=1e-3)


@pytest.mark.long
@pytest.mark.parametrize(
    ("target_mm", "alarms"),
    [
        (10.9, []),
        pytest.param(11.1, [120002], marks=pytest.mark.provokes(120002, 4, axis="Z")),
    ],
)
def test_a_target_counts_with_the_offset(
    distance_bench: Make, say: Any, words: Any, target_mm: float, alarms: list[int]
) -> None:
    made = made_with(distance_bench, counts=True, height_mm=1.0)
    made.run(
        say.command("on", set_pos_mm=0.0), say.dwell(400), say.command("freeze"),
        words.move(3, 600.0, Z=target_mm), say.command("off", wait=True),
    )  # fmt: skip
    assert made.alarm_ids == alarms


@pytest.mark.long
def test_not_counted_a_target_may_be_the_switch(distance_bench: Make, say: Any, words: Any) -> None:
    made = made_with(distance_bench, counts=False, height_mm=1.0)
    made.run(
        say.command("on", set_pos_mm=0.0), say.dwell(400), say.command("freeze"),
        words.move(3, 600.0, Z=12.0), say.command("off", wait=True),
    )  # fmt: skip
    assert made.alarm_ids == []
    assert made.seen.actual_mm[-1] == pytest.approx(12.0, abs=1e-3)
