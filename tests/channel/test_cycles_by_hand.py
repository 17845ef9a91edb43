"""The cycle of a channel without a bus: its begin, its end, and what comes up in a cycle."""

from typing import Any

import pytest
from tests.channel.channel_by_hand import Bench
from tests.channel.test_reactions_by_hand import FEEDHOLD, PROGRAM_ENDS, WARNS, lag

from axisrig.kernel.channel import ChannelState
from axisrig.kernel.channel.path.execution import BlockEnd
from axisrig.kernel.drives.power import Power
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.time.clock import MS

State = ChannelState
END = canon.EndOfProgram(Block(9, 90, "N90"))
SETTLED = 30
"""Cycles that are enough for axes without a lag to be in position."""


def to(words: Any, **target: float) -> canon.LinearMove:
    move: canon.LinearMove = words.move(1, 6000.0, **target)
    return move


def stopping(bench: Bench) -> Bench:
    """An alarm while X is under way, which brakes for 100 cycles."""
    bench.cycle(200)
    bench.channel.plc.report(FEEDHOLD)
    return bench.cycle()


# Begin


def test_drives_are_waited_for_where_they_are_and_the_plc_side_begins_with_the_program(
    words: Any,
) -> None:
    bench = Bench(words)
    bench.links["Z"].power = Power.OFF
    bench.links["Z"].off_mm = 4.0
    bench.start(to(words, X=1.0), END)
    bench.cycle(3)
    assert (bench.state, bench.channel.start_ns, bench.turns) == (State.POWERING, None, 0)
    assert "drives" not in bench.watch.calls
    bench.links["Z"].off_mm = 0.0
    bench.links["Z"].set_mm = 7.0
    bench.links["Z"].power = Power.OPERATING
    bench.cycle()
    assert (bench.state, bench.channel.start_ns, bench.turns) == (State.RUNNING, 5 * MS, 1)
    assert bench.channel.path.position_acs_mm("Z") == 7.0
    assert bench.channel.path.is_moving  # its first block has begun in this cycle
    bench.until(State.ENDED)
    assert [link.set_mm for link in bench.links.values()] == [1.0, 7.0]


# End


def test_a_program_that_ends_well_ends_the_channel_in_its_cycle(words: Any) -> None:
    bench = Bench(words).start(END).until(State.ENDED)
    ends = bench.channel.program_ends_ns
    assert (bench.channel.end_ns, ends) == (bench.clock.now_ns, [bench.clock.now_ns])
    assert (bench.mechanics.asked, bench.ends.found) == (0, [BlockEnd.DONE])


def test_mechanics_that_are_looked_at_go_on_and_the_program_has_ended_before(words: Any) -> None:
    bench = Bench(words, goes_on=True)
    bench.mechanics.sways = 50
    bench.start(END).until(State.READY)
    end_ns = bench.clock.now_ns
    bench.until(State.ENDED)
    assert bench.clock.now_ns - end_ns == 50 * MS
    assert bench.channel.end_ns == end_ns


def test_a_plc_side_that_has_something_to_do_keeps_the_channel_ready(words: Any) -> None:
    """The end is the first cycle in which it has nothing more; mechanics may sway after it."""
    bench = Bench(words, outlives=True)
    bench.is_idle, bench.mechanics.sways = False, 7
    bench.start(END).until(State.READY)
    program_end_ns = bench.clock.now_ns
    bench.cycle(20)
    assert (bench.state, bench.channel.end_ns, bench.mechanics.asked) == (State.READY, None, 0)
    bench.is_idle = True
    bench.cycle()
    assert bench.channel.end_ns == program_end_ns + 21 * MS
    bench.until(State.ENDED)
    assert bench.clock.now_ns == program_end_ns + (21 + 7) * MS
    assert bench.channel.end_ns == program_end_ns + 21 * MS
    assert bench.channel.program_ends_ns == [program_end_ns]


@pytest.mark.parametrize("kept_by", ["busy", "beside", "path"])
def test_a_program_ends_when_everything_has_been_carried_out(words: Any, kept_by: str) -> None:
    block = Block(1, 10, "N10")
    bench = Bench(words)
    before: list[canon.Command] = []
    if kept_by == "beside":
        before = [canon.IndependentMove(block, "Z", 5.0, feed_mm_min=6000.0)]
    elif kept_by == "path":
        before = [to(words, X=5.0)]
    bench.answers.busy = kept_by == "busy"
    bench.start(*before, END)
    bench.cycle(SETTLED)
    assert bench.state is State.RUNNING
    bench.answers.busy = False
    bench.until(State.ENDED)
    assert [link.set_mm for link in bench.links.values()] == {
        "busy": [0.0, 0.0], "beside": [0.0, 5.0], "path": [5.0, 0.0]
    }[kept_by]  # fmt: skip


def test_an_answer_that_a_block_waits_for_keeps_the_next_one(words: Any) -> None:
    bench = Bench(words)
    bench.answers.waiting = True
    bench.start(to(words, X=5.0), END).cycle(20)
    assert bench.links["X"].set_mm == 0.0
    bench.answers.waiting = False
    bench.cycle(2)
    assert bench.links["X"].set_mm > 0.0


# What comes up


def test_a_channel_that_an_alarm_stops_ends_when_its_axes_and_mechanics_rest(words: Any) -> None:
    bench = Bench(words)
    bench.mechanics.sways = 10
    stopping(bench.start(to(words, X=500.0), END))
    came_ns = bench.clock.now_ns
    assert (bench.state, bench.channel.end_ns) == (State.STOPPING, None)
    while not bench.channel.path.has_stopped:
        bench.cycle()
        assert bench.state is State.STOPPING
    bench.until(State.ENDED)
    stood_ns = bench.channel.end_ns
    assert stood_ns is not None
    assert stood_ns - came_ns == pytest.approx(100 * MS, abs=MS)  # 100 mm/s, 1000 mm/s²; to a cycle
    assert bench.clock.now_ns == stood_ns + 10 * MS
    assert bench.ends.found == [BlockEnd.STOPPED]
    assert bench.ids == ([50059], [])
    assert bench.switched_off[0] == ("Y",)


def test_an_alarm_of_axes_at_rest_is_waited_with_for_a_cycle(words: Any) -> None:
    bench = Bench(words).start(to(words, X=0.0), canon.Dwell(Block(2, 20, "N20"), 10**9), END)
    bench.cycle(5).channel.plc.report(FEEDHOLD)
    bench.cycle()
    assert bench.state is State.STOPPING
    bench.cycle()
    assert (bench.state, bench.channel.end_ns) == (State.ENDED, bench.clock.now_ns)


@pytest.mark.parametrize("where", ["taken", "conditions"])
def test_the_first_alarm_of_a_cycle_that_ends_the_program_counts(words: Any, where: str) -> None:
    """A warning is noted; what comes with the alarm that stops is noted as come up besides."""
    bench = Bench(words).start(to(words, X=500.0), END).cycle(50)
    getattr(bench.watch, where).extend([WARNS, lag("X"), lag("Z"), PROGRAM_ENDS])
    bench.cycle()
    assert bench.ids == ([900035, 900036], [900036, 900110])
    assert [str(alarm.values["axis"]) for alarm in bench.channel.further_alarms] == ["Z", "Y"]
    assert bench.switched_off == [("X",)]
    assert (bench.watch.further, bench.state) == ([], State.STOPPING)
    bench.watch.conditions.append(lag("Z"))
    bench.cycle(3)
    assert bench.ids == ([900035, 900036], [900036, 900110])  # once for each axis


def test_a_warning_alone_goes_on(words: Any) -> None:
    bench = Bench(words).start(to(words, X=5.0), END)
    bench.watch.taken.append(WARNS)
    bench.cycle()
    assert (bench.state, bench.switched_off) == (State.RUNNING, [])
    bench.until(State.ENDED)
    assert (bench.ids, bench.links["X"].set_mm) == (([900035], []), 5.0)


def test_distance_control_has_its_step_once_in_a_cycle_whatever_comes_up(words: Any) -> None:
    bench = Bench(words).start(to(words, X=500.0), END).cycle(10)
    steps: list[bool] = []
    distance: Any = bench.channel.distance
    distance.has_stepped = False

    def step(*, is_stopping: bool = False) -> None:
        steps.append(is_stopping)
        distance.has_stepped = True

    distance.step = step
    for alarms, found in (
        ({}, [False]), ({"taken": [WARNS]}, [False]), ({"conditions": [WARNS]}, [False]),
        ({"taken": [lag("X")]}, [True]), ({}, [True]), ({"taken": [lag("Z")]}, [True]),
    ):  # fmt: skip
        steps.clear()
        distance.has_stepped = False
        for where, alarm in alarms.items():
            getattr(bench.watch, where).extend(alarm)
        bench.cycle()
        assert steps == found


def test_what_stops_it_from_outside_does_so_until_it_has_ended(words: Any) -> None:
    bench = Bench(words).start(to(words, X=500.0), END).cycle(50)
    bench.channel.stop(FEEDHOLD)
    assert (bench.state, bench.ids) == (State.STOPPING, ([50059], []))
    bench.channel.stop(lag("X"))
    assert bench.ids == ([50059], [900036])
    bench.until(State.ENDED).channel.stop(lag("Z"))
    assert bench.ids == ([50059], [900036])
