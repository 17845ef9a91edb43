"""Software limit switches: P-AXIS-00177 to 00179 and 00705."""

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.path.soft_limits import SoftLimits, SoftLimitWatch
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.parameters import ParameterSet
from axisrig.kernel.plc.interface import PlcParticipant

Make = Callable[..., Any]
LIMITS = SoftLimits(negative_mm=-5.0, positive_mm=20.0, tolerance_mm=0.1)


def block(number: int) -> Block:
    return Block(number, number * 10, f"N{number * 10}")


@pytest.mark.long
def test_an_axis_may_go_to_its_switches(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("X", limits=LIMITS))
    bench.run([words.move(1, 6000.0, X=20.0), words.move(2, 6000.0, X=-5.0), words.end()])
    assert bench.alarm_ids == []
    assert bench.final_mm("X") == -5.0


@pytest.mark.parametrize(
    ("alarm_id", "target_mm"),
    [
        pytest.param(120002, 20.0001, marks=pytest.mark.provokes(120002, 4, axis="X")),
        pytest.param(120003, -5.0001, marks=pytest.mark.provokes(120003, 4, axis="X")),
    ],
)
@pytest.mark.parametrize("kind", ["path", "beside", "measuring"])
def test_a_block_beyond_a_switch_is_not_carried_out(
    channel_bench: Make, words: Any, alarm_id: int, target_mm: float, kind: str
) -> None:
    bench = channel_bench(words.axis("X", limits=LIMITS), plane_mm=-400.0)
    beyond = {
        "path": words.move(2, 600.0, X=target_mm),
        "beside": canon.IndependentMove(block(2), "X", target_mm, feed_mm_min=600.0),
        "measuring": words.probe(2, 600.0, X=target_mm),
    }[kind]
    bench.run([words.move(1, 6000.0, X=3.0), beyond, words.end()])
    assert bench.alarm_ids == [alarm_id]
    assert bench.channel.alarms[0].place == "line 2, block N20"
    assert max(bench.set_mm("X")) == bench.final_mm("X") == 3.0


@pytest.mark.provokes(120002, 4, axis="Y")
def test_an_arc_must_not_bulge_beyond_one(channel_bench: Make, words: Any) -> None:
    """From (0, 15) to (10, 15) about (5, 15): its top is at Y 20.0, with a switch at 19.9."""
    bench = channel_bench(
        words.axis("X"), words.axis("Y", start_mm=15.0, limits=SoftLimits(-5.0, 19.9, 0.1))
    )
    arc = canon.ArcMove(
        block(1),
        {"X": 10.0, "Y": 15.0},
        {"X": 5.0, "Y": 15.0},
        {"X": 0.0, "Y": 1.0},
        math.pi,
        600.0,
    )
    bench.run([arc, words.end()])
    assert bench.alarm_ids == [120002]


@pytest.mark.long
def test_an_axis_that_stands_keeps_nobody_from_moving(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("X"), words.axis("Y", start_mm=20.05, limits=LIMITS))
    bench.run([words.move(1, 600.0, X=1.0), words.move(2, 600.0, Y=19.0), words.end()])
    assert bench.alarm_ids == []


@pytest.mark.parametrize(
    ("alarm_id", "start_mm"),
    [
        pytest.param(70021, 19.9, marks=pytest.mark.provokes(70021, 7, axis="X")),
        pytest.param(70022, -4.9, marks=pytest.mark.provokes(70022, 7, axis="X")),
    ],
)
def test_an_axis_that_is_pushed_over_one_stops(
    channel_bench: Make, words: Any, alarm_id: int, start_mm: float
) -> None:
    bench = channel_bench(words.axis("X", start_mm=start_mm, limits=LIMITS, speed_max_mm_s=5000.0))
    axis, sign = bench.axes["X"], 1 if alarm_id == 70021 else -1
    channel = bench.channel

    def push() -> None:
        cycle = (channel._clock.now_ns - channel.start_ns) // 1_000_000
        axis.droop_m = -sign * min(max(0, cycle - 100), 500) * 1e-6  # 1 um a cycle

    channel.plc.join(PlcParticipant(push))
    bench.run([canon.Dwell(block(1), 1_000_000_000), words.end()])
    assert bench.alarm_ids == [alarm_id]
    (alarm,) = channel.alarms
    # 0.1 mm to the switch and 0.1 mm of tolerance, 1 um a cycle from cycle 100 on
    cycle = (channel.alarm_ns[0] - channel.start_ns) // 1_000_000
    assert cycle in (301, 302)
    assert alarm.values["limit_mm"] == f"{start_mm + sign * 0.2:.4f}"


@pytest.mark.parametrize(
    ("check", "kind", "monitored"),
    [
        ("-1", "ACHSTYP_TRANSLATOR", True),
        ("-1", "ACHSTYP_ROTATOR", False),
        ("0", "ACHSTYP_TRANSLATOR", False),
        ("1", "ACHSTYP_ROTATOR", True),
    ],
)
def test_the_list_says_whether_they_are_monitored(check: str, kind: str, monitored: bool) -> None:
    axis = ParameterSet("axis")
    axis.set("kenngr.achs_typ", kind, "test")
    axis.set("kenngr.swe_check", check, "test")
    axis.set("kenngr.swe_pos", "123456", "test")
    limits = SoftLimits(-10_000.0, 12.3456, 0.1) if monitored else None
    assert SoftLimits.read(axis) == limits


class _Link:
    """A drive that stands somewhere, and may lead itself."""

    name = "Z"
    settings = SimpleNamespace(increments_per_mm=100.0)

    def __init__(self, actual_mm: float, leads_itself: bool) -> None:
        self.actual_mm, self.leads_itself = actual_mm, leads_itself
        self.actual_increments = round(actual_mm * 100)


@pytest.mark.parametrize(
    ("actual_mm", "uncounted_mm", "alarm_id"),
    [
        (20.1, None, None),
        (20.2, None, 70021),
        (-5.1, None, None),
        (-5.2, None, 70022),
        (30.0, 10.0, None),  # the offset does not count: the program is at 20
        (15.0, -6.0, 70021),  # it is at 21, and the axis within its switches
        (-4.0, 2.0, 70022),
        (15.0, -5.0, None),
    ],
)
def test_the_watch_looks_at_what_counts_of_the_actual_position(
    actual_mm: float, uncounted_mm: float | None, alarm_id: int | None
) -> None:
    """-5 and 20 mm with a tolerance of 0.1. A drive that leads itself, as in homing, is free."""
    for leads_itself in (False, True):
        link: Any = _Link(actual_mm, leads_itself)
        uncounted = {} if uncounted_mm is None else {"Z": lambda: uncounted_mm}
        watch = SoftLimitWatch({"Z": LIMITS}, {"Z": link}, uncounted)
        if alarm_id is None or leads_itself:
            watch.check()
            continue
        with pytest.raises(Alarm) as raised:
            watch.check()
        assert raised.value.id == alarm_id
