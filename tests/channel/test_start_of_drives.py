"""Drives that start side by side: when the cyclic exchange begins, and what keeps it from that."""

from collections.abc import Callable, Mapping
from typing import Any

import pytest
from tests.channel.conftest import ChannelBench

from axisrig.kernel.channel.path.monitor import Monitor
from axisrig.kernel.channel.state import ChannelState
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS, US, Phase

Make = Callable[..., ChannelBench]
pytestmark = pytest.mark.interpreted
AXES = ("X", "Y", "Z")
FIRST_NS, APART_NS = 2300 * US, 1100 * US
"""The first answer, and the time from each to the next: the third is 4.5 ms after the start."""


class Start:
    """The start of a drive, which answers when it is let."""

    def __init__(self, calls: list[str], name: str) -> None:
        self._calls, self._name = calls, name
        self.answer: Callable[[Alarm | None], None] = lambda _alarm: None

    def begin(self, ended: Callable[[Alarm | None], None]) -> None:
        self._calls.append(self._name)
        self.answer = ended


def failure(axis: str) -> Alarm:
    return Alarm(900008, axis=axis, state="SWITCH_ON_DISABLED", ms=3)


def warning(axis: str) -> Alarm:
    return Alarm(900522, axis=axis, setting="vb_messen", relation="up to", limit="100")


class Starting:
    """A channel whose three drives begin at 0; calls: drives that begin, and turns of the watch."""

    def __init__(self, bench: ChannelBench, words: Any, calls: list[str]) -> None:
        self.bench, self.channel, self.calls = bench, bench.channel, calls
        self.channel.load(iter([words.end()]))
        self.starts = {name: Start(calls, name) for name in AXES}
        self.channel.start_up(list(self.starts.values()))

    def answer(self, order: str, alarms: Mapping[str, Alarm | None]) -> list[ChannelState]:
        """Let drives answer one after the other; return the state after each answer."""
        states: list[ChannelState] = []

        def answered(axis: str) -> None:
            self.starts[axis].answer(alarms.get(axis))
            states.append(self.channel.state)

        for place, axis in enumerate(order):
            at_ns = FIRST_NS + place * APART_NS
            self.bench.scheduler.call_at(at_ns, Phase.APPLICATION, lambda a=axis: answered(a))
        self.bench.scheduler.run_until(FIRST_NS + (len(order) - 1) * APART_NS)
        return states


@pytest.fixture
def starting(
    channel_bench: Make, words: Any, monkeypatch: pytest.MonkeyPatch
) -> Callable[[], Starting]:
    calls: list[str] = []
    for turn in ("prepare", "begin", "end"):
        monkeypatch.setattr(Monitor, turn, lambda _watch, turn=turn: calls.append(turn))
    return lambda: Starting(channel_bench(*map(words.axis, AXES)), words, calls)


ORDERS = ["XYZ", "ZYX", "YZX"]
STARTING, POWERING, ENDED = ChannelState.STARTING, ChannelState.POWERING, ChannelState.ENDED


@pytest.mark.parametrize("order", ORDERS)
def test_the_exchange_begins_at_the_next_whole_period_after_the_last_answer(
    starting: Callable[[], Starting], order: str
) -> None:
    """In whatever order they answer: all were begun before, behind what the kernel shows."""
    found = starting()
    assert found.calls == ["prepare", *AXES]
    assert found.answer(order, {}) == [STARTING, STARTING, POWERING]
    assert found.calls == ["prepare", *AXES, "begin"]
    found.bench.scheduler.run_until(5 * MS - 1)
    assert found.bench.sync_ns() == []
    found.bench.scheduler.run_until(8 * MS - 1)
    requested = [time_ns // MS for time_ns in found.bench.sync_ns()]
    assert requested == [5, 6, 7]
    assert (found.channel.alarms, found.channel.has_ended) == ([], False)


@pytest.mark.parametrize("failed", ["X", "Y", "Z", "XZ", "XYZ"])
@pytest.mark.parametrize("order", ORDERS)
def test_one_drive_that_does_not_start_keeps_all_of_them_from_the_exchange(
    starting: Callable[[], Starting], order: str, failed: str
) -> None:
    """Whether it answers first, between or last; each one leaves its alarm, with its instant."""
    found = starting()
    assert found.answer(order, {axis: failure(axis) for axis in failed})[2:] == [ENDED]
    assert found.calls == ["prepare", *AXES, "end"]
    expected = [(axis, FIRST_NS + k * APART_NS) for k, axis in enumerate(order) if axis in failed]
    axes = [alarm.values["axis"] for alarm in found.channel.alarms]
    assert list(zip(axes, found.channel.alarm_ns, strict=True)) == expected
    found.bench.scheduler.run_until(8 * MS)
    assert found.bench.sync_ns() == []
    assert found.channel.start_ns is None


@pytest.mark.parametrize("order", ORDERS)
def test_a_failed_start_is_waited_with_until_every_drive_has_answered(
    starting: Callable[[], Starting], order: str
) -> None:
    found = starting()
    states = found.answer(order, {order[0]: failure(order[0])})
    assert states == [STARTING, STARTING, ENDED]


@pytest.mark.parametrize("warned", ["X", "Y", "Z", "XYZ"])
def test_a_warning_of_a_start_is_noted_and_stops_nothing(
    starting: Callable[[], Starting], warned: str
) -> None:
    found = starting()
    states = found.answer("XYZ", {axis: warning(axis) for axis in warned})
    assert states == [STARTING, STARTING, POWERING]
    assert [alarm.values["axis"] for alarm in found.channel.alarms] == list(warned)
    found.bench.scheduler.run_until(6 * MS - 1)
    assert len(found.bench.sync_ns()) == 1


@pytest.mark.parametrize("order", ORDERS)
def test_a_warning_after_a_failure_does_not_start_the_exchange(
    starting: Callable[[], Starting], order: str
) -> None:
    found = starting()
    first, _, last = order
    states = found.answer(order, {first: failure(first), last: warning(last)})
    assert states == [STARTING, STARTING, ENDED]
    assert [alarm.id for alarm in found.channel.alarms] == [900008, 900522]


@pytest.mark.parametrize(("now_ns", "first_ms"), [(3 * MS, 3), (3 * MS + 1, 4), (4 * MS - 1, 4)])
def test_an_exchange_that_begins_on_a_period_begins_at_once(
    channel_bench: Make, words: Any, now_ns: int, first_ms: int
) -> None:
    bench = channel_bench(words.axis("Z"))
    bench.channel.load(iter([words.end()]))
    bench.scheduler.call_at(now_ns, Phase.APPLICATION, bench.channel.start)
    bench.scheduler.run_until(first_ms * MS + MS // 2)
    assert [time_ns // MS for time_ns in bench.sync_ns()] == [first_ms]
