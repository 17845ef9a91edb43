"""A PLC side that resets the channel and starts programs: what ends, what stays, what goes on."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest
from tests.channel.conftest import ChannelBench

from axisrig.bench.bus.can.canopen_sim import SimNetwork
from axisrig.bench.bus.can.faults import Alter, Drop, FaultAction
from axisrig.bench.bus.can.frame import Frame
from axisrig.kernel.channel import ChannelSettings, ChannelState
from axisrig.kernel.drives.canopen.startup_steps import StartUpSettings
from axisrig.kernel.drives.canopen.watch import WatchSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.plc.interface import PlcParticipant
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS

Make = Callable[..., ChannelBench]
Acts = dict[int, Callable[[], None]]


class Side:
    """A PLC side that acts in given turns, counted from the start of the first program."""

    def __init__(self, bench: ChannelBench, words: Any, acts: Acts) -> None:
        self.bench, self.words, self.turn = bench, words, 0
        self.acts = dict(acts)
        plc = bench.channel.plc
        plc.join(PlcParticipant(self.take_turn, outlives_program=True, is_idle=self.is_idle))

    def is_idle(self) -> bool:
        return self.turn > max(self.acts, default=0) + 5

    def take_turn(self) -> None:
        act = self.acts.get(self.turn)
        self.turn += 1
        if act is not None:
            act()


def reset(bench: ChannelBench) -> Callable[[], None]:
    def act() -> None:
        bench.channel.plc.wants_reset = True

    return act


def start(bench: ChannelBench, *commands: canon.Command) -> Callable[[], None]:
    def act() -> None:
        bench.channel.plc.program = iter(commands)

    return act


def dwell(number: int, ms: int) -> canon.Dwell:
    return canon.Dwell(Block(number, number * 10, f"N{number * 10}"), ms * MS)


def begun(bench: ChannelBench) -> int:
    """The sample of the first turn."""
    return next(k for k, s in enumerate(bench.samples) if s.time_ns >= bench.channel.start_ns)


@pytest.mark.long
def test_the_path_stops_with_its_deceleration_and_the_next_program_goes_on_from_there(
    channel_bench: Make, words: Any
) -> None:
    """300 cycles of 50 mm/s: v t - v²/2a at the reset, v²/2a more until it stands: v t = 15 mm."""
    bench = channel_bench(words.axis("Z"))
    after = start(bench, words.move(1, 3000.0, Z=5.0), words.end())
    Side(bench, words, {300: reset(bench), 450: after})
    bench.run([words.move(1, 3000.0, Z=100.0), words.move(2, 3000.0, Z=0.0), words.end()])
    z, first = bench.set_mm("Z"), begun(bench)
    assert z[first + 440] == pytest.approx(15.0, abs=1e-9)
    steps = [b - a for a, b in pairwise(z)]
    assert max(abs(b - a) for a, b in pairwise(steps)) <= 1000 * 1e-6 + 1e-9
    assert z[-1] == 5.0
    assert bench.alarm_ids == []
    assert len(bench.channel.resets_ns) == len(bench.channel.program_ends_ns) == 1
    # set positions stand 50 cycles behind the turn that resets
    assert bench.channel.resets_ns[0] - bench.samples[first + 300].time_ns == 50 * MS


def in_dwell(words: Any) -> list[canon.Command]:
    return [dwell(1, 5000)]


def in_stop(words: Any) -> list[canon.Command]:
    return [canon.ProgramStop(Block(1, 10, "N10 M0"), False)]


def in_function(words: Any) -> list[canon.Command]:
    return [canon.TechnologyFunction(Block(1, 10, "N10 M50"), "M", 50)]


def at_the_end(words: Any) -> list[canon.Command]:
    return []


@pytest.mark.parametrize("waiting", [in_dwell, in_stop, in_function, at_the_end])
def test_what_a_program_waits_for_ends_with_it(
    channel_bench: Make, words: Any, waiting: Callable[[Any], list[canon.Command]]
) -> None:
    settings = ChannelSettings(start_after_ns=5000 * MS)
    bench = channel_bench(words.axis("Z"), settings=settings)
    bench.channel.plc.acknowledged_later = frozenset({"M50"})
    after = start(bench, words.move(1, 3000.0, Z=1.0), words.end())
    Side(bench, words, {100: reset(bench), 110: after})
    bench.run([*waiting(words), words.end()])
    first = begun(bench)
    assert bench.set_mm("Z")[first + 111] > 0.0
    assert bench.final_mm("Z") == 1.0
    assert bench.alarm_ids == []
    assert all(event.time_ns <= bench.channel.end_ns for event in bench.channel.plc.events)


@pytest.mark.long
def test_an_axis_beside_the_path_stops_by_itself(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z"))
    beside = canon.IndependentMove(Block(1, 10, "N10"), "Z", 50.0, feed_mm_min=3000.0)
    after = start(bench, words.move(1, 3000.0, Z=0.0), words.end())
    Side(bench, words, {200: reset(bench), 300: after})
    wait = canon.WaitIndependent(Block(2, 20, "N20"), ("Z",))
    bench.run([beside, wait, words.end()])
    assert bench.set_mm("Z")[begun(bench) + 290] == pytest.approx(10.0, abs=1e-9)
    assert bench.final_mm("Z") == 0.0


@pytest.mark.parametrize(("turn", "method"), [(1, 34), (20, 34), (100, 34), (100, 17)])
@pytest.mark.long(but=1)
def test_a_homing_ends_and_the_drive_follows_the_next_program(
    channel_bench: Make, words: Any, turn: int, method: int
) -> None:
    """Asked for its mode, on its way to mode 6, on its way to the index pulse with 20 mm/s, and
    after 900190, as no switch is there.

    The machine is where the next program sends it, and its lag counts again.
    """
    per_mm = 2**20 / 10
    speed, a = round(20 * per_mm), round(400 * per_mm)
    writes = [(0x6098, 0, method), (0x6099, 1, speed), (0x6099, 2, speed), (0x609A, 0, a)]
    axis = words.axis("Z", start_mm=41.0)
    homing = StartUpSettings(writes=writes)
    bench = channel_bench(axis, start_up=homing, lag_limit_mm=2.0)
    after = start(bench, words.move(1, 600.0, Z=42.0), words.wait(1), words.end())
    place = bench.axes["Z"].position_at
    acts = {turn: reset(bench), 600: after, 1200: lambda: None}
    Side(bench, words, acts)
    bench.run([canon.Homing(Block(1, 10, "N10"), (("Z",),)), words.end()])
    first = begun(bench)
    times = [sample.time_ns for sample in bench.samples[first:]]
    assert bench.alarm_ids == [900190] * (method == 17)
    assert len(bench.channel.resets_ns) == 1
    assert (place(times[turn]) > 0.0415) is (turn == 100 and method == 34)
    assert bench.set_mm("Z")[first + 599] == pytest.approx(place(times[599]) * 1e3, abs=0.001)
    assert place(times[1199]) * 1e3 == pytest.approx(42.0, abs=0.001)
    assert not bench.links[0].leads_itself
    back_ns = [t for t, i, d in bench.frames if i == 0x601 and d[1:5] == b"\x60\x60\0\x08"][1:]
    assert len(back_ns) == (turn > 1)  # the first one is of the start-up
    for time_ns in back_ns:  # the axis stands by then
        assert place(time_ns) == pytest.approx(place(time_ns - 10 * MS), abs=1e-8)


@pytest.mark.long
@pytest.mark.parametrize("how", ["end", "reset", "alarm"])
def test_a_coupling_is_one_of_its_program(channel_bench: Make, words: Any, how: str) -> None:
    """X2 follows X to 0.5 mm and allows 5 mm/s; the next program moves X alone, with 10 mm/s."""
    bench = channel_bench(words.axis("X"), words.axis("X2", start_mm=7.0, speed_max_mm_s=5.0))
    pair = canon.AxisPair("X2", "X", (0.3, 0.4))
    on = canon.AxisLinkOn(Block(1, 10, "N10"), 1, (pair,))
    program = [on, words.move(2, 600.0, X=0.5)]
    acts = {350: start(bench, words.move(1, 600.0, X=1.5), words.end())}
    if how != "end":
        program.append(dwell(3, 5000))
        acts[300] = reset(bench)
    if how == "alarm":
        alarm = Alarm(900036, axis="X", lag_mm="2", limit_mm="1")
        acts[250] = lambda: bench.channel.plc.report(alarm)
    Side(bench, words, acts)
    bench.run([*program, words.end()])
    assert bench.alarm_ids == [900036] * (how == "alarm")
    assert bench.final_mm("X") == 1.5
    assert bench.final_mm("X2") == pytest.approx(7.5, abs=1e-5)  # an increment
    steps = [b - a for a, b in pairwise(bench.set_mm("X"))]
    assert max(steps[begun(bench) + 350 :]) == pytest.approx(0.01, abs=1e-9)


@pytest.mark.long
def test_a_run_ends_without_a_result_and_its_probe_is_off(channel_bench: Make, words: Any) -> None:
    """At 50 mm/s from 40: 5 mm further the plane; the second run is armed anew and finds it."""
    bench = channel_bench(words.axis("Z", start_mm=40.0), plane_mm=30.0)
    again = start(bench, words.probe(1, 600.0, Z=0.0), words.wait(2), words.end())
    side = Side(bench, words, {100: reset(bench), 200: again})
    asked: list[bool] = []
    side.acts[190] = lambda: asked.append(bench.links[0].is_probing)
    bench.run([words.probe(1, 600.0, Z=0.0), words.wait(2), words.end()])
    first, second = bench.channel.records
    assert first.end_ns == bench.samples[begun(bench) + 100].time_ns
    assert (first.latched_mm, asked) == ({}, [False])
    assert second.latched_mm["Z"] == pytest.approx(30.0, abs=1e-4)


@pytest.mark.provokes(900290, 1, state="RUNNING")
def test_a_start_is_refused_while_a_program_runs_and_behind_an_alarm(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z"))
    program = words.move(1, 3000.0, Z=1.0), words.end()
    stop = Alarm(900036, axis="Z", lag_mm="2", limit_mm="1")
    acts = {
        20: start(bench, *program),
        60: lambda: bench.channel.plc.report(stop),
        150: start(bench, *program),
        160: reset(bench),
        170: start(bench, *program),
    }
    Side(bench, words, acts)
    bench.run([words.move(1, 600.0, Z=-100.0), words.end()])
    assert bench.alarm_ids == [900290, 900036, 900290]
    assert bench.final_mm("Z") == 1.0
    assert [a.values.get("state") for a in bench.channel.alarms] == ["RUNNING", None, "ERROR"]


@pytest.mark.long
@pytest.mark.parametrize("alarm_id", [900036, 900029])
def test_axes_that_an_alarm_took_off_the_path_are_given_back_where_they_stand(
    channel_bench: Make, words: Any, alarm_id: int
) -> None:
    """One brakes by its ramp, the other lets its drive stop by itself: neither moves by a reset."""
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    values = {"lag_mm": "2", "limit_mm": "1"} if alarm_id == 900036 else {"jump_mm": "1"}
    stop = Alarm(alarm_id, axis="Z", **values)
    link, stood = bench.links[1], []
    after = start(bench, words.move(1, 3000.0, Y=3.0, Z=4.0), words.end())
    acts = {200: lambda: bench.channel.plc.report(stop), 600: reset(bench), 700: after}
    for turn in (590, 690):
        acts[turn] = lambda: stood.append((link.actual_mm, link.lag_mm))
    Side(bench, words, acts)
    bench.run([words.move(1, 3000.0, Y=30.0, Z=40.0), words.end()])
    (before_mm, _), (after_mm, lag_mm) = stood
    assert after_mm == pytest.approx(before_mm, abs=1e-4)
    assert lag_mm == pytest.approx(0.0, abs=1e-4)
    assert (bench.final_mm("Y"), bench.final_mm("Z")) == (3.0, 4.0)
    assert bench.alarm_ids == [alarm_id]
    assert all(link.state is State.OPERATION_ENABLED for link in bench.links)


@pytest.mark.long
def test_a_reset_acknowledges_the_fault_of_a_drive_as_no_start_does(
    channel_bench: Make, words: Any
) -> None:
    """Without `fault_reset` of the rig the start leaves a fault for the operator to look at."""
    bench = channel_bench(words.axis("Z"))
    after = start(bench, words.move(1, 3000.0, Z=1.0), words.end())

    def fault() -> None:
        bench.nodes["Z"].servo.fault(0x4310, 1 << 3, bench.scheduler.now_ns)

    Side(bench, words, {30: fault, 100: reset(bench), 300: after})
    bench.run([words.move(1, 600.0, Z=-20.0), words.end()])
    assert bench.alarm_ids == [900005]
    assert bench.links[0].state is State.OPERATION_ENABLED
    assert bench.final_mm("Z") == 1.0


def test_a_drive_that_stays_silent_does_not_keep_the_plc_side_from_its_turn(
    channel_bench: Make, words: Any
) -> None:
    """Its telegrams stay out for good: the reset ends in the same alarm again, and the run ends."""
    bench = channel_bench(words.axis("Z"))

    def silence() -> None:
        bench.segment.add_fault(lambda frame, *_: Drop() if frame.arbitration_id == 0x181 else None)

    Side(bench, words, {50: silence, 200: reset(bench)})
    bench.run([words.move(1, 600.0, Z=10.0), words.end()])
    assert bench.alarm_ids == [900006, 900006]
    assert bench.channel.state is ChannelState.ENDED


def test_without_anything_behind_it_a_program_ends_the_run_in_its_cycle(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z"))
    bench.run([words.end()])
    assert bench.channel.end_ns == bench.channel.program_ends_ns[0] == bench.samples[-1].time_ns


@pytest.mark.parametrize(
    ("last", "turns"), [("end", {60: "next"}), ("reset", {30: "reset", 90: "next"})]
)
def test_the_next_program_begins_with_the_slope_and_the_weights_of_the_lists(
    channel_bench: Make, words: Any, last: str, turns: dict[int, str]
) -> None:
    """1 mm at 10 mm/s with 1000 mm/s²: 100 and 10 ms, not the ramps and a tenth of before."""
    bench = channel_bench(words.axis("Z"))
    block = Block(1, 10, "N10")
    chosen = (
        canon.SlopeChoice(block, "TRAPEZ"),
        canon.DynamicWeights(block, "acceleration", {"Z": 0.1}),
        canon.DynamicWeights(block, "ramp_time", {"Z": 3.0}),
    )
    after = start(bench, words.move(1, 600.0, Z=1.0), words.end())
    Side(
        bench,
        words,
        {turn: after if what == "next" else reset(bench) for turn, what in turns.items()},
    )
    bench.run([*chosen, *([dwell(2, 5000)] if last == "reset" else []), words.end()])
    z = bench.set_mm("Z")
    begin = next(n for n, mm in enumerate(z) if mm != z[0])
    assert z.index(1.0) - begin + 1 == 110
    assert (z[begin], bench.alarm_ids) == (pytest.approx(0.0005, abs=1e-9), [])


@pytest.mark.long
def test_no_program_finds_what_another_one_has_measured(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=40.0), plane_mm=35.0)
    found: list[float | None] = []

    def ask() -> None:
        found.append(bench.channel.measured_acs_mm("Z"))

    after = start(bench, dwell(1, 100), words.end())
    Side(bench, words, {1990: ask, 2000: after, 2010: ask})
    bench.run([words.probe(1, 600.0, Z=0.0), words.wait(2), words.end()])
    assert found == [pytest.approx(35.0, abs=1e-4), None]


@pytest.mark.long
def test_what_the_bus_has_done_once_is_over_with_the_reset(channel_bench: Make, words: Any) -> None:
    """5 ms of a node that sends without pause hold a SYNC back; a TPDO1 comes a byte too short."""
    bench = channel_bench(words.axis("Z"))
    other = SimNetwork(bench.segment.port("other master")).connect()

    def flood() -> None:
        for _ in range(40):
            other.send_message(0x001, bytes(8))

    move = words.move(1, 600.0, Z=0.0), words.move(2, 600.0, Z=1.0), words.end()
    acts = {20: flood, 100: reset(bench), 180: start(bench, *move)}
    acts |= {200: lambda: other.send_message(0x181, bytes(7)), 260: reset(bench)}
    Side(bench, words, acts | {340: start(bench, *move)})
    bench.prepare([words.move(1, 600.0, Z=-20.0), words.end()])
    bench.finish(2000 * MS)
    assert bench.alarm_ids == [900031, 900028]
    assert len(bench.channel.resets_ns) == 2
    assert bench.final_mm("Z") == 1.0


RPDO, TPDO1, TPDO2, EMCY, HEARTBEAT = 0x201, 0x181, 0x281, 0x081, 0x701
WATCHED = {
    "start_up": StartUpSettings(heartbeat_ms=10),
    "watches": (WatchSettings(heartbeat_ns=30 * MS),),
}


def dropped(can_id: int, count: int) -> Callable[[ChannelBench, SimNetwork], None]:
    return lambda bench, _other: altered(bench, can_id, count, lambda _data: None)


def altered(
    bench: ChannelBench, can_id: int, count: int, change: Callable[[bytes], bytes | None]
) -> None:
    """Change so many frames with an identifier, None takes one off the bus."""
    left = [count]

    def hook(frame: Frame, _port: Any, _attempt: int) -> FaultAction | None:
        if frame.arbitration_id != can_id or not left[0]:
            return None
        left[0] -= 1
        data = change(frame.data)
        return Drop() if data is None else Alter(data)

    bench.segment.add_fault(hook)


@pytest.mark.long
@pytest.mark.parametrize(
    ("alarm_id", "options", "happens"),
    [
        (900006, {}, dropped(TPDO1, 8)),
        (900006, {}, dropped(TPDO2, 8)),
        (900006, {}, lambda _bench, other: other.send_message(0, bytes((128, 1)))),
        (900005, {"start_up": StartUpSettings(rpdo_timeout_ms=5)}, dropped(RPDO, 50)),
        (900036, {"lag_limit_mm": 0.5}, dropped(RPDO, 200)),
        (900023, WATCHED, dropped(HEARTBEAT, 6)),
        (900025, {}, lambda _bench, other: other.send_message(EMCY, b"\x10\x43\x09" + bytes(5))),
        (
            900029,
            {},
            lambda bench, _other: altered(
                bench, TPDO1, 1, lambda data: data[:2] + b"\0\0\0\7" + data[6:]
            ),
        ),
    ],
    ids=["TPDO1", "TPDO2", "NMT", "RPDO", "lag", "heartbeat", "emergency", "jump"],
)
def test_after_a_reset_the_next_program_moves_the_machine_whatever_has_come_up(
    channel_bench: Make,
    words: Any,
    alarm_id: int,
    options: dict[str, Any],
    happens: Callable[[ChannelBench, SimNetwork], None],
) -> None:
    bench = channel_bench(words.axis("Z"), **options)
    other = SimNetwork(bench.segment.port("other master")).connect()
    move = words.move(1, 600.0, Z=0.0), words.move(2, 600.0, Z=1.0), words.end()
    acts = {
        30: lambda: happens(bench, other),
        380: lambda: other.send_message(0, bytes((1, 1))),  # NMT start, as somebody has to say
        400: reset(bench),
        1400: start(bench, *move),
        1410: lambda: None,
    }
    Side(bench, words, acts)
    bench.prepare([words.move(1, 1800.0, Z=-20.0), words.end()])
    bench.finish(4000 * MS)
    assert bench.alarm_ids == [alarm_id]
    assert len(bench.channel.resets_ns) == 1
    at_mm = bench.axes["Z"].position_at(bench.scheduler.now_ns) * 1e3
    assert (bench.final_mm("Z"), at_mm) == (1.0, pytest.approx(1.0, abs=0.001))
