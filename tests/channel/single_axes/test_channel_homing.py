"""G74: the drive homes, the channel takes over where it then stands."""

import itertools
import math
from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.drives.canopen.startup_steps import StartUpSettings
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block

Make = Callable[..., Any]
S = 1_000_000_000
INCREMENT_MM = 10 / 2**20
PRESENT_POSITION, NEGATIVE_SWITCH = 35, 17


def home(*groups: tuple[str, ...]) -> canon.Homing:
    return canon.Homing(Block(3, 30, "N30"), groups)


def found(method: int, home_mm: float) -> StartUpSettings:
    """Tell every drive its method, and where home lies in its positions."""
    offset = round(-home_mm / INCREMENT_MM)
    return StartUpSettings(writes=[(0x6098, 0, method), (0x607C, 0, offset)])


def modes(bench: Any, node: int) -> list[int]:
    """What was written to 6060 over SDO."""
    return [
        data[4]
        for _, can_id, data in bench.frames
        if can_id == 0x600 + node and data[0] >> 5 == 1 and data[1:4] == b"\x60\x60\x00"
    ]


@pytest.mark.long
def test_home_is_where_the_drive_says_and_the_program_goes_on_from_there(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("Z", start_mm=40.0), start_up=found(PRESENT_POSITION, 100.0))
    bench.run(
        [words.move(2, 600.0, Z=42.0), home(("Z",)), words.move(4, 600.0, Z=103.0), words.end()]
    )
    assert bench.alarm_ids == []
    assert bench.final_mm("Z") == 103.0
    # the machine has moved by 2 mm and by the 3 mm from home on, nothing else
    assert bench.axes["Z"].position_at(bench.scheduler.now_ns) * 1e3 == pytest.approx(45, abs=0.01)
    assert modes(bench, 1) == [8, 6, 8]


def test_the_jump_to_the_reference_and_the_lag_are_no_faults(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(
        words.axis("Z", start_mm=40.0), lag_limit_mm=0.5, start_up=found(PRESENT_POSITION, 500.0)
    )
    bench.run([home(("Z",)), words.end()])
    assert bench.alarm_ids == []
    assert bench.final_mm("Z") == pytest.approx(500.0, abs=INCREMENT_MM)


@pytest.mark.long
@pytest.mark.parametrize("buffer_cycles", [0, 5])
def test_nothing_of_the_time_before_is_left_in_the_buffer(
    channel_bench: Make, words: Any, buffer_cycles: int
) -> None:
    bench = channel_bench(
        words.axis("Z", start_mm=40.0),
        buffer_cycles=buffer_cycles,
        start_up=found(PRESENT_POSITION, 500.0),
    )
    bench.run(
        [words.move(2, 600.0, Z=42.0), home(("Z",)), words.move(4, 600.0, Z=501.0), words.end()]
    )
    assert bench.alarm_ids == []
    sent = [sample.sent_mm[0] for sample in bench.samples]
    jumps = [b for a, b in itertools.pairwise(sent) if abs(b - a) > 1.0]
    assert len(jumps) <= 2  # of the first cycle of all, and to the reference
    moved_mm = [axis.position_at(bench.scheduler.now_ns) * 1e3 for axis in bench.axes.values()]
    assert moved_mm == pytest.approx([43.0], abs=0.01)


def test_groups_home_one_after_the_other_and_a_group_together(
    channel_bench: Make, words: Any
) -> None:
    bench = channel_bench(words.axis("X"), words.axis("Z"), start_up=found(PRESENT_POSITION, 10.0))
    bench.run([home(("Z",), ("X",)), home(("X", "Z")), words.end()])
    assert bench.alarm_ids == []
    entered = {
        node: [t for t, i, d in bench.frames if i == 0x600 + node and d[1:5] == b"\x60\x60\0\x06"]
        for node in (1, 2)
    }
    left = [t for t, i, d in bench.frames if i == 0x602 and d[1:5] == b"\x60\x60\0\x08"]
    assert entered[2][0] < left[1] < entered[1][0]  # left[0]: the start-up
    assert abs(entered[1][1] - entered[2][1]) < 1_000_000
    known = bench.channel.single.homed  # each axis once for each time that it was homed
    assert [axis for _, axis in known] == ["Z", "X", "X", "Z"]
    times = [at_ns for at_ns, _ in known]
    assert left[1] < times[0] < entered[1][0] < times[1] < entered[1][1] < times[2] == times[3]


@pytest.mark.provokes(900190, 4, axis="Z", method=17, error="0x0000")
def test_900190_tells_what_the_drive_says(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(
        words.axis("Z", start_mm=40.0), start_up=found(NEGATIVE_SWITCH, 0.0)
    )  # no switch is wired
    bench.run([home(("Z",)), words.move(4, 600.0, Z=41.0), words.end()])
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.entry.reaction_class) == (900190, 4)
    assert (alarm.values["axis"], alarm.values["method"]) == ("Z", NEGATIVE_SWITCH)
    assert int(alarm.values["statusword"], 16) & 1 << 13
    assert alarm.values["error"] == "0x0000"
    assert "N30" in str(alarm)


def adopt(*axes: str) -> canon.AdoptActual:
    return canon.AdoptActual(Block(3, 30, "N30"), axes)


@pytest.mark.long
def test_adopting_the_actual_position_waits_for_the_lag_of_the_motion_to_pass(
    channel_bench: Make, words: Any
) -> None:
    """At 50 mm/s the axis lags by 1.25 mm, at rest by nothing."""
    bench = channel_bench(words.axis("Z", start_mm=140.0))
    bench.run([words.move(2, 3000.0, Z=150.0), adopt("Z"), words.wait(3), words.end()])
    assert bench.alarm_ids == []
    assert bench.final_mm("Z") == pytest.approx(150.0, abs=3 * INCREMENT_MM)


@pytest.mark.long
@pytest.mark.parametrize("buffer_cycles", [0, 5])
def test_adopting_the_actual_position_moves_an_axis_by_its_droop(
    channel_bench: Make, words: Any, buffer_cycles: int
) -> None:
    spec = words.axis("Z", start_mm=40.0, droop_mm=0.02, window_mm=0.1)
    bench = channel_bench(spec, buffer_cycles=buffer_cycles)
    bench.run([words.move(2, 600.0, Z=45.0), adopt("Z"), words.end()])
    assert bench.alarm_ids == []
    # with Kv = 40 1/s, 2 increments in 50 cycles are a gap of 2.5 / (1 - exp(-2)) at their begin
    assert bench.final_mm("Z") == pytest.approx(45.0 - 0.02, abs=3 * INCREMENT_MM)
    # what the drive is told is the new place at once: nothing of the old one is in the buffer
    sent = [sample.sent_mm[0] for sample in bench.samples]
    set_mm = bench.set_mm("Z")
    assert sent.index(bench.final_mm("Z")) == set_mm.index(bench.final_mm("Z"))


@pytest.mark.long
def test_adopting_takes_an_axis_on_a_stop_where_it_stands(channel_bench: Make, words: Any) -> None:
    """1 mm short: it never gets into its window, and that is no fault (70082) here."""
    bench = channel_bench(words.axis("Z", start_mm=40.0, droop_mm=1.0, settling_ns=S // 2))
    bench.prepare([words.move(2, 600.0, Z=45.0), adopt("Z"), words.end()])
    assert bench.scheduler.run_while(lambda: bench.channel.path.position_acs_mm("Z") < 45.0, 10 * S)
    assert bench.scheduler.run_while(lambda: bench.set_mm("Z")[-1] == 45.0, 10 * S)
    assert bench.alarm_ids == []
    assert bench.set_mm("Z")[-1] == pytest.approx(44.0, abs=0.01)


def sway(bench: Any) -> None:
    """Let Z swing by 10 um with a period of 6.3 ms."""
    axis = bench.axes["Z"]
    still = axis.motor_position_m_at
    axis.motor_position_m_at = lambda t: still(t) + 1e-5 * math.sin(t / 1e6)


@pytest.mark.provokes(900200, 4, axis="Z")
def test_900200_for_an_axis_that_never_rests(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Z", start_mm=40.0, settling_ns=100_000_000))
    sway(bench)
    bench.run([adopt("Z"), words.end()])
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.entry.reaction_class) == (900200, 4)
    # it may pass its window in the very cycle in which its time is over
    assert (alarm.values["axis"], alarm.values["ms"] in range(101, 105)) == ("Z", True)
    assert "N30" in str(alarm)


def test_an_axis_that_sways_inside_its_window_is_adopted_after_its_settling_time(
    channel_bench: Make, words: Any
) -> None:
    spec = words.axis("Z", start_mm=40.0, settling_ns=100_000_000, window_mm=0.05)
    bench = channel_bench(spec)
    sway(bench)
    bench.run([adopt("Z"), words.end()])
    assert bench.alarm_ids == []
    assert bench.final_mm("Z") == pytest.approx(40.0, abs=0.05)


@pytest.mark.parametrize("resets", ["homing", "exchange"])
def test_a_prepared_probe_is_reset(channel_bench: Make, words: Any, resets: str) -> None:
    """FCT-C4 section 7.2: one of the prepared axes resets the preparation of all."""
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    block = Block(2, 20, "N20")
    prepare = canon.PrepareProbe(block, ("Y", "Z"))
    other = canon.AxisExchange(block, ("Z",), ())
    reset = home(("Z",)) if resets == "homing" else other
    bench.prepare([prepare, words.move(2, 600.0, Y=1.0), reset, words.end()])
    measurement = bench.channel.measurement
    assert bench.scheduler.run_while(lambda: not measurement.prepared, 10 * S)
    assert measurement.prepared == {"Y", "Z"}
    assert bench.scheduler.run_while(lambda: bool(measurement.prepared), 10 * S)
    assert not bench.channel.has_ended
    bench.finish()
    assert bench.alarm_ids == []
