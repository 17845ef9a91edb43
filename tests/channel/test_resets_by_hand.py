"""A channel without a bus whose PLC side goes on after a program: its errors, resets and starts."""

from typing import Any

import pytest
from tests.channel.channel_by_hand import Bench
from tests.channel.test_cycles_by_hand import END, State, stopping, to
from tests.channel.test_reactions_by_hand import FEEDHOLD, lag

from axisrig.kernel.channel.path.execution import BlockEnd
from axisrig.kernel.drives.power import Power, PowerOrder
from axisrig.kernel.measuring.run import RunRecord
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import MS


def side(words: Any) -> Bench:
    bench = Bench(words, outlives=True)
    bench.is_idle = False
    return bench


def test_behind_an_alarm_the_plc_side_has_its_turns_and_what_fails_is_noted(words: Any) -> None:
    bench = stopping(side(words).start(to(words, X=500.0), END)).until(State.ERROR)
    assert bench.channel.program_ends_ns == [bench.clock.now_ns]
    turns = bench.turns
    for _ in range(3):
        bench.watch.taken.append(lag("X"))
        bench.cycle()
    assert (bench.turns - turns, bench.state) == (3, State.ERROR)
    assert bench.ids == ([50059], [900036])


def test_a_reset_that_comes_while_an_alarm_stops_waits_for_its_end(words: Any) -> None:
    bench = stopping(side(words).start(to(words, X=500.0), END))
    bench.channel.plc.wants_reset = True
    bench.cycle(20)
    assert (bench.state, bench.channel.plc.wants_reset) == (State.STOPPING, True)
    bench.until(State.READY)
    assert not bench.channel.plc.wants_reset
    (stood_ns,) = bench.channel.program_ends_ns
    assert bench.clock.now_ns == stood_ns + MS
    assert bench.channel.resets_ns == [bench.clock.now_ns]
    assert bench.links["X"].orders[-1] is PowerOrder.SWITCH_ON


def test_a_reset_of_a_running_program_brakes_and_is_ready_when_the_axes_rest(words: Any) -> None:
    bench = side(words).start(to(words, X=500.0), END).cycle(200)
    bench.channel.plc.wants_reset = True
    bench.cycle()
    begun_ns = bench.clock.now_ns
    assert (bench.state, bench.ends.found) == (State.RESETTING, [BlockEnd.RESET])
    bench.until(State.READY)
    # 100 mm/s by 1000 mm/s², to a cycle
    assert bench.clock.now_ns - begun_ns == pytest.approx(100 * MS, abs=MS)
    assert (bench.ids, bench.channel.program_ends_ns) == (([], []), [])
    bench.channel.plc.program = iter([to(words, X=0.0), END])
    bench.cycle()
    assert bench.state is State.RUNNING
    bench.until(State.READY)
    assert bench.links["X"].set_mm == 0.0
    assert len(bench.channel.program_ends_ns) == 1


@pytest.mark.parametrize("state", [State.RUNNING, State.STOPPING, State.ERROR, State.RESETTING])
def test_a_start_is_taken_when_the_channel_is_ready_and_else_refused(
    words: Any, state: State
) -> None:
    bench = side(words).start(to(words, X=500.0), END).cycle(200)
    if state in (State.STOPPING, State.ERROR):
        bench.channel.plc.report(FEEDHOLD)
        bench.cycle().until(state)
    elif state is State.RESETTING:
        bench.channel.plc.wants_reset = True
        bench.cycle()
    known = len(bench.channel.alarms)
    bench.channel.plc.program = iter([END])
    bench.cycle()
    (warning,) = bench.channel.alarms[known:]
    assert (warning.id, warning.values["state"]) == (900290, state.name)
    assert (bench.state, bench.channel.plc.program) == (state, None)
    bench.cycle()
    assert len(bench.channel.alarms) == known + 1


def test_a_reset_and_a_start_in_one_cycle_refuse_the_start(words: Any) -> None:
    bench = side(words).start(END).until(State.READY)
    bench.channel.plc.wants_reset, bench.channel.plc.program = True, iter([END])
    bench.cycle()
    assert bench.ids == ([900290], [])


# What a program may ask


def test_a_program_asks_for_the_axis_that_it_names(words: Any) -> None:
    bench = Bench(words).start(END)
    bench.links["Z"].off_mm = 0.25
    channel = bench.channel
    assert [channel.actual_acs_mm(axis) for axis in "XZ"] == [0.0, 0.25]
    assert [channel.position_acs_mm(axis) for axis in "XZ"] == [0.0, 0.0]
    assert [channel.is_sercos(axis) for axis in "XZ"] == [False, True]
    assert [channel.axis_numbered(number) for number in (2, 3, 4, 5)] == [None, "X", "Z", None]
    assert [channel.is_measuring(axis) for axis in "XZ"] == [False, False]
    assert (channel.measured_acs_mm("X"), channel.measurement_ok("X")) == (None, False)
    assert channel.channel_distance() is None


def test_a_program_finds_nothing_that_one_before_has_measured(words: Any) -> None:
    """Until the next one begins the value is there, also behind the end and a reset."""
    bench = side(words).start(canon.Dwell(END.block, 5 * MS), END)
    for end in ("end", "reset"):
        bench.channel.measurement.keep(RunRecord(("X",), latched_mm={"X": 12.5}))
        assert (bench.channel.measured_acs_mm("X"), bench.channel.measurement_ok("X")) == (
            12.5, True,
        )  # fmt: skip
        if end == "reset":
            bench.channel.plc.wants_reset = True
            bench.cycle()
        bench.until(State.READY)
        assert bench.channel.measured_acs_mm("X") == 12.5
        bench.channel.plc.program = iter([canon.Dwell(END.block, 5 * MS), END])
        bench.cycle()
        assert bench.channel.measured_acs_mm("X") is None


def test_a_reset_acknowledges_faults_and_the_start_does_not(words: Any) -> None:
    bench = side(words).start(END)
    assert not any(link.acknowledges_faults for link in bench.links.values())
    bench.links["Z"].settings.fault_reset = True
    bench.channel.plc.wants_reset = True
    bench.cycle(2).until(State.READY)
    assert all(link.acknowledges_faults for link in bench.links.values())


def test_a_reset_waits_for_every_drive_and_leaves_one_that_was_off_where_it_is(
    words: Any,
) -> None:
    bench = side(words).start(to(words, X=5.0), END).until(State.READY)
    z = bench.links["Z"]
    z.power, z.off_mm = Power.OFF, 3.0
    bench.channel.plc.wants_reset = True
    bench.cycle(10)
    assert (bench.state, bench.channel.resets_ns) == (State.RESETTING, [])
    assert bench.channel.path.position_acs_mm("Z") != 0.0
    z.power, z.off_mm = Power.OPERATING, 0.0
    bench.cycle()
    assert (bench.state, bench.channel.path.position_acs_mm("X")) == (State.READY, 5.0)
    assert bench.channel.resets_ns == [bench.clock.now_ns]


def test_distance_control_is_stepped_while_a_reset_brakes_and_commands_nothing(words: Any) -> None:
    """In each cycle once: as behind an alarm; as in operation from READY on."""
    bench = side(words).start(to(words, X=500.0), END).cycle(200)
    steps: list[bool] = []
    distance: Any = bench.channel.distance
    distance.step = lambda *, is_stopping=False: steps.append(is_stopping)
    bench.channel.plc.wants_reset = True
    bench.cycle()
    steps.clear()
    for _ in range(5):
        bench.cycle()
    assert (bench.state, steps) == (State.RESETTING, [True] * 5)
    bench.until(State.READY)
    steps.clear()
    bench.cycle(3)
    assert steps == [False] * 3
