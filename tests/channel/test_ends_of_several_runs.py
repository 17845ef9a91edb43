"""Ends that concern several: runs that a reset breaks off, axes that sway behind an alarm."""

import itertools
from typing import Any

import pytest
from tests.channel import channel_by_hand
from tests.channel.probing import test_measurement_by_hand
from tests.channel.test_cycles_by_hand import END, to
from tests.channel.test_reactions_by_hand import AXIS_HALTS, PROGRAM_ENDS, WARNS

from axisrig.kernel.channel import ChannelState
from axisrig.kernel.channel.alarm_log import AlarmLog, faulty_axes
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS

State = ChannelState


@pytest.mark.parametrize("order", list(itertools.permutations("XYZ")))
def test_a_reset_ends_every_run_that_is_under_way_and_none_that_has_ended(
    order: tuple[str, ...],
) -> None:
    """Two axes beside the path and one that has measured, in whatever order they began."""
    bench = test_measurement_by_hand.Bench()
    runs = {axis: bench.arm(1, axis) for axis in order}
    for number, (axis, run) in enumerate(runs.items()):
        run.record.latched_mm[axis] = float(number)
    done = runs["Y"].record
    done.end_ns, before = 3 * MS, dict(done.latched_mm)
    bench.clock.now_ns = 9 * MS
    bench.measurement.reset()
    for axis in "XZ":
        assert (runs[axis].record.end_ns, runs[axis].record.latched_mm) == (9 * MS, {})
    assert (done.end_ns, done.latched_mm) == (3 * MS, before)
    assert [record.axes for record in bench.measurement.records] == [(axis,) for axis in order]
    bench.clock.now_ns = 20 * MS
    bench.measurement.reset()  # they have ended
    assert {runs[axis].record.end_ns for axis in "XZ"} == {9 * MS}


@pytest.mark.parametrize("sways", [0, 1, 6])
@pytest.mark.parametrize("alarm", [PROGRAM_ENDS, AXIS_HALTS])
def test_behind_an_alarm_the_end_is_where_the_axes_were_stopped(
    words: Any, sways: int, alarm: Alarm
) -> None:
    """The mechanics may sway on; the channel ends when they rest, and its end is before that."""
    bench = channel_by_hand.Bench(words)
    bench.mechanics.sways = sways
    bench.start(to(words, X=100.0), END)
    bench.cycle(50)
    bench.channel.plc.report(alarm)
    bench.cycle()
    for _ in range(3000):
        if bench.channel.end_ns is not None:
            break
        bench.cycle()
    stopped_ns = bench.clock.now_ns
    assert bench.channel.end_ns == stopped_ns
    assert bench.state is (State.STOPPING if sways else State.ENDED)
    bench.until(State.ENDED)
    assert bench.clock.now_ns - stopped_ns == sways * MS
    assert (bench.channel.end_ns, bench.mechanics.asked) == (stopped_ns, sways + 1)


def test_a_channel_that_is_stopped_from_outside_reacts_until_it_has_ended(words: Any) -> None:
    bench = channel_by_hand.Bench(words)
    bench.start(to(words, X=100.0), END)
    bench.cycle(50)
    bench.channel.stop(PROGRAM_ENDS)
    assert bench.state is State.STOPPING
    bench.channel.stop(AXIS_HALTS)  # comes up besides
    assert bench.ids == ([PROGRAM_ENDS.id], [AXIS_HALTS.id])
    bench.until(State.ENDED)
    bench.channel.stop(WARNS)
    assert bench.ids == ([PROGRAM_ENDS.id], [AXIS_HALTS.id])
    assert not bench.channel.is_measuring("X")


# --- the log -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("values", "axes"),
    [
        ({"axis": "X"}, ("X",)),
        ({"axis": "X Y"}, ("X", "Y")),
        ({"owner": "axis Z"}, ("Z",)),
        ({"owner": "the channel"}, ()),
        ({"owner": "axis Z", "axis": "X"}, ("Z",)),
        ({"owner": "the channel", "axis": "X"}, ("X",)),
        ({}, ()),
    ],
)
def test_an_alarm_names_its_axes_as_such_or_as_the_owner_of_what_has_failed(
    values: dict[str, str], axes: tuple[str, ...]
) -> None:
    alarm = Alarm(50059, axis="Q")
    alarm.values = values  # type: ignore[assignment]
    assert faulty_axes(alarm) == axes


def test_what_comes_up_besides_is_noted_once_for_each_id_and_axis() -> None:
    clock: Any = type("Clock", (), {"now_ns": 0})()
    log = AlarmLog(clock)
    log.register(Alarm(50059, axis="X"))
    for now_ns, alarm_id, axis in (
        (1, 50059, "X"),  # has stopped the axes already
        (2, 50059, "Y"),
        (3, 50637, "X"),
        (4, 50059, "Y"),
        (5, 50637, "Y"),
        (6, 50637, "X"),
    ):
        clock.now_ns = now_ns
        log.register_further(Alarm(alarm_id, axis=axis))
    assert [(a.id, a.values["axis"]) for a in log.further] == [
        (50059, "Y"), (50637, "X"), (50637, "Y"),
    ]  # fmt: skip
    assert log.further_ns == [2, 3, 5]
    clock.now_ns = 7
    log.register(Alarm(50059, axis="X"))  # a warning may come again
    assert ([a.id for a in log.alarms], log.alarm_ns) == ([50059, 50059], [0, 7])
