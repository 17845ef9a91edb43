"""What a channel without a bus goes on watching while it stops, and when its SYNCs are."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.channel_by_hand import Bench
from tests.channel.test_cycles_by_hand import END, SETTLED, State, to
from tests.channel.test_reactions_by_hand import FEEDHOLD, lag

from axisrig.kernel.distance import DistanceState
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.time.clock import MS


@pytest.mark.parametrize("begun_us", [0, 1, 2300, 4000])
def test_the_first_sync_is_at_a_whole_period_and_each_next_one_a_period_later(
    words: Any, begun_us: int
) -> None:
    bench = Bench(words)
    bench.clock.now_ns = begun_us * 1000
    calls: list[tuple[int, Any]] = []
    bench.clock.call_at = lambda time_ns, _phase, act: calls.append((time_ns, act))
    bench.channel.load(iter([END]))
    bench.channel.start()
    first_ns = -(-begun_us // 1000) * MS
    for number in range(3):
        ((time_ns, sync),) = calls
        calls.clear()
        assert time_ns == first_ns + number * MS
        bench.clock.now_ns = time_ns
        sync()
        cycle, following = calls
        assert cycle[0] == time_ns + bench.channel.timing.offset_ns
        assert bench.channel.sync_ns == time_ns
        calls[:] = [following]


def test_what_comes_up_while_it_stops_is_noted_besides(words: Any) -> None:
    """Of the drives and of the telegrams, in each cycle until the axes rest, and after it."""
    bench = Bench(words, outlives=True).start(to(words, X=500.0), END).cycle(200)
    bench.channel.plc.report(FEEDHOLD)
    bench.cycle()
    assert bench.state is State.STOPPING
    bench.watch.calls.clear()
    bench.watch.conditions.append(lag("X"))
    bench.cycle()
    assert bench.watch.calls == ["take", "drives"]
    assert bench.ids == ([50059], [900036])
    bench.watch.taken.append(lag("Z"))
    bench.cycle()
    assert [str(a.values["axis"]) for a in bench.channel.further_alarms] == ["X", "Z"]
    bench.until(State.ERROR)
    bench.watch.calls.clear()
    bench.cycle()
    assert bench.watch.calls == ["take", "drives"]


def test_a_drive_that_fails_while_a_reset_brakes_ends_the_reset(words: Any) -> None:
    bench = Bench(words, outlives=True).start(to(words, X=500.0), END).cycle(200)
    bench.channel.plc.wants_reset = True
    bench.cycle()
    assert bench.state is State.RESETTING
    bench.watch.calls.clear()
    bench.cycle()
    assert bench.watch.calls == ["take", "drives"]
    bench.watch.conditions.append(lag("X"))
    bench.cycle()
    assert (bench.state, bench.ids) == (State.STOPPING, ([900036], []))
    bench.until(State.ERROR)
    assert bench.channel.resets_ns == []
    bench.channel.plc.wants_reset = True
    bench.is_idle = False
    bench.until(State.READY)
    assert bench.channel.resets_ns == [bench.clock.now_ns]


def test_the_faulty_axis_alone_is_switched_off_of_what_comes_with_a_warning(words: Any) -> None:
    """The control of the axis that the alarm names, not of one that a warning names."""
    bench = Bench(words).start(to(words, X=500.0), END).cycle(50)
    bench.watch.taken.extend([Alarm(900035, axis="Z", emcy="0x8120"), lag("X")])
    bench.cycle()
    assert bench.switched_off == [("X",)]


@pytest.mark.parametrize("how", ["alarm", "reset", "end"])
def test_however_a_program_ends_no_probe_stays_prepared(words: Any, how: str) -> None:
    dwell = canon.Dwell(Block(2, 20, "N20"), 20 * MS)
    bench = Bench(words, outlives=True).start(dwell, END).cycle(3)
    bench.channel.measurement.prepared.update("XZ")
    bench.is_idle = False
    if how == "alarm":
        bench.channel.plc.report(FEEDHOLD)
        bench.until(State.ERROR)
    else:
        bench.channel.plc.wants_reset = how == "reset"
        bench.cycle()
        bench.until(State.READY)
    assert bench.channel.measurement.prepared == set()


def test_what_a_program_writes_to_drives_is_noted_with_its_cycle(words: Any) -> None:
    writes = [
        canon.DriveWrite(Block(n, 10 * n, f"N{n}0"), axis, "KEY", float(n), waits=False)
        for n, axis in ((1, "X"), (2, "Z"))
    ]
    bench = Bench(words)
    begun: list[Any] = []
    bench.answers.begin = begun.append  # type: ignore[method-assign]
    bench.start(writes[0], canon.Dwell(Block(3, 30, "N30"), 5 * MS), writes[1], END)
    bench.until(State.ENDED)
    assert [command for _, command in bench.channel.drive_writes] == writes == begun
    (first_ns, _), (second_ns, _) = bench.channel.drive_writes
    assert second_ns - first_ns >= 5 * MS


# Distance control and measurement as the channel asks them


def test_what_comes_up_in_distance_control_beside_its_alarm_is_noted_once(words: Any) -> None:
    bench = Bench(words, outlives=True).start(to(words, X=500.0), END).cycle(50)
    distance: Any = bench.channel.distance
    of_cycle = [[lag("X"), lag("Z")], [], [FEEDHOLD]]

    def step(*, is_stopping: bool = False) -> None:
        distance.has_stepped = True
        alarms = of_cycle.pop(0) if of_cycle else []
        if alarms:
            distance.further = alarms[1:]
            raise alarms[0]

    distance.step = step
    bench.cycle()
    assert bench.ids == ([900036], [900036])
    assert bench.channel.further_alarms[0].values["axis"] == "Z"
    assert distance.further == []
    bench.cycle(2)
    assert bench.ids == ([900036], [900036, 50059])


def test_a_program_waits_for_an_offset_that_runs_out_and_names_its_end(words: Any) -> None:
    bench = Bench(words)
    distance: Any = bench.channel.distance
    control = SimpleNamespace(state=DistanceState.TURNING_OFF, forget_set_values=lambda: None)
    distance.axes["Z"] = SimpleNamespace(
        control=control, take=lambda: None, step=lambda: None, show=lambda _state: None,
        is_moving=False, is_idle=True, has_offset=False,
    )  # fmt: skip
    places: list[str] = []
    distance.end_program = places.append
    bench.start(END).cycle(SETTLED)
    assert (bench.state, places) == (State.RUNNING, [])
    control.state = DistanceState.INACTIVE
    bench.until(State.ENDED)
    assert places == [END.block.place]


def test_an_axis_measures_where_its_own_run_is_under_way(words: Any) -> None:
    bench = Bench(words)
    single: Any = bench.channel.single
    single.measuring_state = {"X": "MOVING"}.get
    assert [bench.channel.is_measuring(axis) for axis in "XZ"] == [True, False]


def test_an_axis_that_passes_its_limits_while_the_path_stops_brakes_by_itself(words: Any) -> None:
    """Z, after X has ended the program; its set position of the cycle is sent unjudged."""
    bench = Bench(words).start(to(words, X=500.0), END).cycle(200)
    bench.channel.plc.report(FEEDHOLD)
    bench.cycle()
    path: Any = bench.channel.path
    judged: list[bool] = []
    alone: list[tuple[str, ...]] = []

    def advance(_superpose: Any, *, is_judged: bool = True) -> Alarm | None:
        judged.append(is_judged)
        return Alarm(900500, axis="Z", what="") if is_judged else None

    path.advance = advance
    bench.channel.reactions.stop_alone = lambda axes: alone.append(tuple(axes))  # type: ignore[method-assign]
    bench.cycle()
    assert (judged, alone) == ([True, False], [("Z",)])
    assert bench.ids == ([50059], [900500])
