"""How long a program waits in a dwell time or a stop, what starts it again, and what ends it."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.program_by_hand import Program

from axisrig.kernel.channel.path.settings import ChannelSettings
from axisrig.kernel.channel.pauses import Pauses
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.plc.interface import PlcAction, PlcEvent
from axisrig.kernel.time.clock import MS

BLOCK = Block(3, 30, "N30")
BEGIN_NS = 40 * MS
PERIOD_NS = 2 * MS


class Bench:
    """Pauses of a channel with cycles of 2 ms; the axes are in position unless a test says so."""

    def __init__(self, start_after_ns: int | None = 9 * MS, *, optional_stop: bool = True) -> None:
        self.clock: Any = SimpleNamespace(now_ns=BEGIN_NS)
        self.is_in_position, self.events = True, list[PlcEvent]()
        settings = ChannelSettings(start_after_ns=start_after_ns, optional_stop=optional_stop)
        self.pauses = Pauses(
            self.clock, PERIOD_NS, lambda: self.is_in_position, self.events, settings
        )
        self.program = Program(self.pauses)

    def waited_ns(self) -> int:
        """Go on cycle by cycle until the program is not busy any more."""
        while self.program.is_busy():
            self.clock.now_ns += PERIOD_NS
        return int(self.clock.now_ns) - BEGIN_NS


def dwell(duration_ns: int) -> canon.Dwell:
    return canon.Dwell(BLOCK, duration_ns)


def stop(*, optional: bool = False) -> canon.ProgramStop:
    return canon.ProgramStop(BLOCK, optional)


@pytest.mark.parametrize(
    ("duration_ns", "waited_ms"),
    [(0, 0), (1, 2), (2 * MS - 1, 2), (2 * MS, 2), (2 * MS + 1, 4), (9 * MS, 10), (10 * MS, 10)],
)
def test_a_dwell_time_takes_whole_cycles_and_no_less_than_it_says(
    duration_ns: int, waited_ms: int
) -> None:
    bench = Bench()
    bench.program.say(dwell(duration_ns))
    assert bench.waited_ns() == waited_ms * MS
    assert bench.events == []


def test_a_dwell_time_counts_from_its_own_begin() -> None:
    """The second begins 4 ms after the end of the first, and is as short as it says."""
    bench = Bench()
    bench.program.say(dwell(6 * MS))
    assert bench.waited_ns() == 6 * MS
    bench.clock.now_ns += 4 * MS
    bench.program.say(dwell(2 * MS))
    assert bench.waited_ns() == 12 * MS


@pytest.mark.parametrize(
    ("start_after_ns", "waited_ms"), [(0, 2), (1, 2), (2 * MS, 2), (9 * MS, 10), (10 * MS, 10)]
)
@pytest.mark.parametrize("optional", [False, True])
def test_a_stop_waits_for_the_operator_and_a_cycle_at_least(
    start_after_ns: int, waited_ms: int, optional: bool
) -> None:
    """The stop and the start that ends it are events of the PLC side, with their instants."""
    bench = Bench(start_after_ns)
    command = stop(optional=optional)
    bench.program.say(command)
    start_ns = BEGIN_NS + waited_ms * MS
    assert bench.events == [PlcEvent(BEGIN_NS, command), PlcEvent(start_ns, command, True)]
    assert bench.waited_ns() == waited_ms * MS


@pytest.mark.parametrize("start_after_ns", [None, 9 * MS])
def test_an_optional_stop_that_is_switched_off_is_none(start_after_ns: int | None) -> None:
    bench = Bench(start_after_ns, optional_stop=False)
    bench.program.say(stop(optional=True))
    assert (bench.waited_ns(), bench.events) == (0, [])


@pytest.mark.parametrize(("optional", "word"), [(False, "M0"), (True, "M1")])
@pytest.mark.parametrize("optional_stop", [False, True])
def test_900170_for_a_stop_that_nobody_ends(optional: bool, word: str, optional_stop: bool) -> None:
    bench = Bench(None, optional_stop=optional_stop)
    if optional and not optional_stop:
        bench.program.say(stop(optional=True))
        return
    with pytest.raises(Alarm) as caught:
        bench.program.say(stop(optional=optional))
    assert (caught.value.id, caught.value.values["word"]) == (900170, word)
    assert (bench.events, bench.program.is_busy()) == ([], False)


@pytest.mark.parametrize(
    ("command", "waits"), [(canon.ExactStop(BLOCK), True), (stop(), True), (dwell(2 * MS), False)]
)
def test_exact_stop_and_stops_wait_until_the_axes_are_there(command: Any, waits: bool) -> None:
    bench = Bench()
    bench.is_in_position = False
    if waits:
        with pytest.raises(AssertionError):
            bench.program.say(command)
    else:
        bench.program.say(command)
    bench.is_in_position = True
    bench.program.say(command)


def test_an_exact_stop_takes_no_time_of_its_own() -> None:
    bench = Bench()
    bench.program.say(canon.ExactStop(BLOCK))
    assert (bench.waited_ns(), bench.events) == (0, [])


# A reset


@pytest.mark.parametrize("passed_ms", [0, 4, 8])
def test_a_reset_ends_a_dwell_time(passed_ms: int) -> None:
    bench = Bench()
    bench.program.say(dwell(10 * MS))
    bench.clock.now_ns += passed_ms * MS
    assert bench.program.is_busy()
    bench.pauses.reset()
    assert (bench.program.is_busy(), bench.events) == (False, [])
    bench.program.say(dwell(2 * MS))  # of the next program
    assert bench.waited_ns() == (passed_ms + 2) * MS


@pytest.mark.parametrize("passed_ms", [0, 4, 8])
def test_a_reset_ends_a_stop_and_takes_the_start_of_the_operator_back(passed_ms: int) -> None:
    """In its place stands what has happened, at the instant of the reset, with the place of N30."""
    bench = Bench()
    bench.program.say(stop())
    began, _ = bench.events
    bench.clock.now_ns += passed_ms * MS
    bench.pauses.reset()
    assert not bench.program.is_busy()
    at_ns = BEGIN_NS + passed_ms * MS
    ended = PlcAction("stop of the program: ended by the reset", BLOCK.place)
    assert bench.events == [began, PlcEvent(at_ns, ended)]
    bench.clock.now_ns += 20 * MS
    bench.pauses.reset()  # nothing waits any more
    assert bench.events == [began, PlcEvent(at_ns, ended)]


@pytest.mark.parametrize("after_ms", [10, 12])
def test_a_start_that_has_been_stays_and_so_do_events_of_others(after_ms: int) -> None:
    """At its instant or later; what other parts of the PLC side do, also later, is not touched."""
    bench = Bench()
    bench.program.say(stop())
    before = list(bench.events)
    other = PlcEvent(BEGIN_NS + 50 * MS, PlcAction("tool is changed", ""))
    bench.events.append(other)
    bench.clock.now_ns += after_ms * MS
    bench.pauses.reset()
    assert bench.events == [*before, other]


def test_of_two_stops_the_one_that_waits_is_ended() -> None:
    bench = Bench()
    bench.program.say(stop())
    assert bench.waited_ns() == 10 * MS
    first = list(bench.events)
    bench.program.say(stop())
    bench.clock.now_ns += 2 * MS
    bench.pauses.reset()
    assert bench.events[:2] == first
    assert [event.starts_again for event in bench.events] == [False, True, False, False]
