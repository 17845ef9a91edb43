"""What each reaction class does to the set positions of a path over two axes.

Y and Z run a 3-4-5 path at 50 mm/s: Y at 30, Z at 40 mm/s. Y brakes with 1000, Z with 4000 mm/s^2,
so the path with min(1000 / 0.6, 4000 / 0.8) = 1000 / 0.6 mm/s^2. Expected ways are v^2 / 2a.
"""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest

from axisrig.kernel.channel import ChannelSettings
from axisrig.kernel.drives.power import Power
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon

Make = Callable[..., Any]
S, T_S = 1_000_000_000, 1e-3
Y_MM_S, Z_MM_S = 30.0, 40.0
OWN_Y_MM, OWN_Z_MM = 30.0**2 / 2000.0, 40.0**2 / 8000.0
LAG = {"lag_mm": "2", "limit_mm": "1"}


class Stop:
    """A run that an alarm has met at full speed; step: the first cycle behind it."""

    def __init__(self, make: Make, words: Any, alarm: Alarm, **settings: Any) -> None:
        axes = words.axis("Y"), words.axis("Z", a_mm_s2=4000.0)
        self.bench = make(*axes, settings=ChannelSettings(**settings))
        self.bench.prepare([words.move(1, 3000.0, Y=60.0, Z=80.0), words.end()])
        scheduler, samples = self.bench.scheduler, self.bench.samples
        assert scheduler.run_while(lambda: not samples or samples[-1].set_mm[0] < 12.0, 10 * S)
        self.step = len(samples)
        self.bench.channel.stop(alarm)
        self.bench.finish()

    def set_mm(self, axis: str) -> list[float]:
        return self.bench.set_mm(axis)

    def way_mm(self, axis: str) -> float:
        """From the set position at the alarm to the last one."""
        values = self.set_mm(axis)
        return values[-1] - values[self.step - 1]

    @property
    def is_on_the_line(self) -> bool:
        return self.set_mm("Z") == pytest.approx([y / 0.6 * 0.8 for y in self.set_mm("Y")])

    def has_ended_with_closed_loops(self) -> bool:
        return self.bench.channel.has_ended and all(
            link.power is Power.OPERATING and link.keeps_operating for link in self.bench.links
        )


@pytest.mark.long
def test_class_1_goes_on(channel_bench: Make, words: Any) -> None:
    stop = Stop(channel_bench, words, Alarm(900035, axis="Z", emcy="0x8120"))
    assert stop.bench.alarm_ids == [900035]
    assert (stop.set_mm("Y")[-1], stop.set_mm("Z")[-1]) == (60.0, 80.0)


@pytest.mark.parametrize(
    "alarm", [Alarm(900105, reason="none"), Alarm(44011, axis="Z")], ids=["class 2", "class 3"]
)
@pytest.mark.long
def test_classes_2_and_3_end_the_program_and_stop_no_motion(
    channel_bench: Make, words: Any, alarm: Alarm
) -> None:
    stop = Stop(channel_bench, words, alarm)
    assert (stop.set_mm("Y")[-1], stop.set_mm("Z")[-1]) == (60.0, 80.0)
    assert stop.bench.alarm_ids == [alarm.id]
    assert stop.has_ended_with_closed_loops()


@pytest.mark.long
def test_class_2_brakes_axes_that_move_by_themselves(channel_bench: Make, words: Any) -> None:
    bench = channel_bench(words.axis("Y"), words.axis("Z", a_mm_s2=4000.0))
    beside = canon.IndependentMove(words.end().block, "Z", 80.0, feed_mm_min=3000.0)
    bench.prepare([beside, words.move(1, 3000.0, Y=60.0), words.end()])
    bench.scheduler.run_while(lambda: not bench.samples or bench.set_mm("Y")[-1] < 12.0, 10 * S)
    z_mm = bench.set_mm("Z")[-1]
    bench.channel.stop(Alarm(900105, reason="none"))
    bench.finish()
    assert bench.final_mm("Y") == 60.0
    assert bench.final_mm("Z") - z_mm == pytest.approx(50.0**2 / 8000.0, abs=1e-9)


def test_class_2_brakes_a_run_on_the_path(channel_bench: Make, words: Any) -> None:
    """What is decoded is carried out, but nobody waits for the signal of the run any more."""
    bench = channel_bench(words.axis("Z", a_mm_s2=4000.0))
    bench.prepare([words.probe(1, 3000.0, Z=80.0), words.wait(1), words.end()])
    bench.scheduler.run_while(lambda: not bench.samples or bench.set_mm("Z")[-1] < 12.0, 10 * S)
    z_mm = bench.set_mm("Z")[-1]
    bench.channel.stop(Alarm(900105, reason="none"))
    bench.finish()
    assert bench.final_mm("Z") - z_mm == pytest.approx(50.0**2 / 8000.0, abs=1e-9)


@pytest.mark.long
def test_class_4_stops_all_axes_on_the_path(channel_bench: Make, words: Any) -> None:
    stop = Stop(channel_bench, words, Alarm(900070))
    assert stop.is_on_the_line
    assert stop.way_mm("Y") == pytest.approx(OWN_Y_MM, abs=1e-9)
    assert stop.way_mm("Z") == pytest.approx(OWN_Y_MM / 0.6 * 0.8, abs=1e-9)
    assert stop.has_ended_with_closed_loops()


@pytest.mark.long
@pytest.mark.parametrize(("faulty", "other"), [("Z", "Y"), ("Y", "Z")])
def test_class_7_brakes_the_faulty_axis_by_its_own_ramp_and_the_other_on_the_path(
    channel_bench: Make, words: Any, faulty: str, other: str
) -> None:
    stop = Stop(channel_bench, words, Alarm(900036, axis=faulty, **LAG))
    own_mm = {"Y": OWN_Y_MM, "Z": OWN_Z_MM}
    on_path_mm = {"Y": OWN_Y_MM, "Z": OWN_Y_MM / 0.6 * 0.8}
    assert stop.way_mm(faulty) == pytest.approx(own_mm[faulty], abs=1e-9)
    assert stop.way_mm(other) == pytest.approx(on_path_mm[other], abs=1e-9)
    assert stop.is_on_the_line is (faulty == "Y")  # the own ramp of Y is that of the path
    assert stop.has_ended_with_closed_loops()


@pytest.mark.long
def test_the_own_ramp_is_one_of_constant_deceleration(channel_bench: Make, words: Any) -> None:
    stop = Stop(channel_bench, words, Alarm(900036, axis="Z", **LAG))
    steps = [b - a for a, b in pairwise(stop.set_mm("Z")[stop.step - 1 :])]
    expected = [Z_MM_S * T_S - (k + 0.5) * 4000.0 * T_S**2 for k in range(10)]
    assert steps[:10] == pytest.approx(expected, abs=1e-9)
    assert set(steps[10:]) == {0.0}


def test_class_7_while_the_axis_accelerates(channel_bench: Make, words: Any) -> None:
    """Rest to rest: z = a t^2 / 2 up to the alarm, and as far again behind it at the same rate."""
    bench = channel_bench(words.axis("Z"))
    bench.prepare([words.move(1, 30000.0, Z=80.0), words.end()])
    bench.scheduler.run_while(lambda: not bench.samples or bench.set_mm("Z")[-1] < 5.0, 10 * S)
    begun_mm = bench.set_mm("Z")[-1]
    bench.channel.stop(Alarm(900036, axis="Z", **LAG))
    bench.finish()
    assert bench.final_mm("Z") == pytest.approx(2.0 * begun_mm, abs=1e-9)


@pytest.mark.long
def test_class_5_stops_the_faulty_axis_at_once(channel_bench: Make, words: Any) -> None:
    alarm = Alarm(70082, axis="Z", lag_mm="1", window_mm="0.1", ms=10)
    stop = Stop(channel_bench, words, alarm)
    assert stop.way_mm("Z") == 0.0
    assert stop.way_mm("Y") == pytest.approx(OWN_Y_MM, abs=1e-9)
    assert stop.has_ended_with_closed_loops()


@pytest.mark.long
def test_class_5_stops_the_faulty_axis_at_once_under_p_chan_00218_too(
    channel_bench: Make, words: Any
) -> None:
    alarm = Alarm(70082, axis="Y", lag_mm="1", window_mm="0.1", ms=10)
    stop = Stop(channel_bench, words, alarm, each_axis_halts=True)
    assert stop.way_mm("Y") == 0.0
    assert stop.way_mm("Z") == pytest.approx(OWN_Z_MM, abs=1e-9)


@pytest.mark.long
def test_a_drive_that_does_not_follow_stops_by_itself_and_the_others_are_led_to_their_stop(
    channel_bench: Make, words: Any
) -> None:
    """900029 of Z: its set positions would stop nothing; Y brakes on the path with closed loop."""
    stop = Stop(channel_bench, words, Alarm(900029, axis="Z", jump_mm="1"))
    y, z = stop.bench.links
    assert (y.power, y.keeps_operating, z.keeps_operating) == (Power.OPERATING, True, False)
    assert stop.way_mm("Y") == pytest.approx(OWN_Y_MM, abs=1e-9)


@pytest.mark.long
def test_class_6_stops_every_axis_at_once(channel_bench: Make, words: Any) -> None:
    stop = Stop(channel_bench, words, Alarm(60207, axis="Z", channel=1))
    assert (stop.way_mm("Y"), stop.way_mm("Z")) == (0.0, 0.0)
    assert stop.has_ended_with_closed_loops()


@pytest.mark.long
def test_class_7_on_an_arc(channel_bench: Make, words: Any) -> None:
    """A quarter circle of 20 mm from X20 Y0: X brakes by its own ramp, Y as in class 4."""

    def stopped_by(alarm: Alarm) -> tuple[float, float, float, float]:
        bench = channel_bench(words.axis("X", start_mm=20.0, a_mm_s2=4000.0), words.axis("Y"))
        target, centre = {"X": 0.0, "Y": 20.0}, {"X": 0.0, "Y": 0.0}
        block, tangent = words.end().block, {"X": 0.0, "Y": 1.0}
        arc = canon.ArcMove(block, target, centre, tangent, math.pi / 2.0, 3000.0)
        bench.prepare([arc, words.end()])
        bench.scheduler.run_while(lambda: not bench.samples or bench.set_mm("Y")[-1] < 10.0, 10 * S)
        here = bench.samples[-1].set_mm
        bench.channel.stop(alarm)
        bench.finish()
        return (*here, bench.final_mm("X"), bench.final_mm("Y"))

    x_mm, y_mm, x_end_mm, y_end_mm = stopped_by(Alarm(900036, axis="X", **LAG))
    x_mm_s = 50.0 * math.sin(math.atan2(y_mm, x_mm))
    assert x_mm - x_end_mm == pytest.approx(x_mm_s**2 / 8000.0, abs=1e-4)
    *_, x_path_mm, y_path_mm = stopped_by(Alarm(900070))
    assert y_end_mm == y_path_mm
    assert math.hypot(x_path_mm, y_path_mm) == pytest.approx(20.0, abs=1e-5)


@pytest.mark.long
def test_class_7_of_an_axis_that_moves_beside_the_path(channel_bench: Make, words: Any) -> None:
    """Z by itself at 50 mm/s, Y on the path: Z by its own ramp, Y by the feedhold."""
    bench = channel_bench(words.axis("Y"), words.axis("Z", a_mm_s2=4000.0))
    beside = canon.IndependentMove(words.end().block, "Z", 80.0, feed_mm_min=3000.0)
    bench.prepare([beside, words.move(1, 3000.0, Y=60.0), words.end()])
    bench.scheduler.run_while(lambda: not bench.samples or bench.set_mm("Y")[-1] < 12.0, 10 * S)
    y_mm, z_mm = bench.samples[-1].set_mm
    bench.channel.stop(Alarm(900036, axis="Z", **LAG))
    bench.finish()
    assert bench.final_mm("Y") - y_mm == pytest.approx(50.0**2 / 2000.0, abs=1e-9)
    assert bench.final_mm("Z") - z_mm == pytest.approx(50.0**2 / 8000.0, abs=1e-9)


@pytest.mark.long
def test_p_chan_00218_lets_every_axis_brake_by_its_own_ramp(
    channel_bench: Make, words: Any
) -> None:
    alarm = Alarm(900036, axis="Y", **LAG)
    stop = Stop(channel_bench, words, alarm, each_axis_halts=True)
    assert stop.way_mm("Y") == pytest.approx(OWN_Y_MM, abs=1e-9)
    assert stop.way_mm("Z") == pytest.approx(OWN_Z_MM, abs=1e-9)


@pytest.mark.long
def test_an_alarm_of_class_7_without_an_axis_stops_on_the_path(
    channel_bench: Make, words: Any
) -> None:
    stop = Stop(channel_bench, words, Alarm(900071, segment="can1", reason="gone"))
    assert stop.is_on_the_line
    assert stop.way_mm("Y") == pytest.approx(OWN_Y_MM, abs=1e-9)


def test_class_2_carries_out_what_is_decoded_and_nothing_more(
    channel_bench: Make, words: Any
) -> None:
    """The look-ahead meets the fault while the first block has not begun to move."""

    def commands() -> Any:
        yield words.move(1, 3000.0, Z=5.0)
        yield words.move(2, 3000.0, Z=8.0)
        yield words.message(2, "there", synchronous=True)
        raise Alarm(900105, place="line 3, block N30", reason="division by zero")

    bench = channel_bench(words.axis("Z")).run(commands())
    (alarm,) = bench.channel.alarms
    assert (alarm.id, alarm.place) == (900105, "line 3, block N30")
    assert bench.final_mm("Z") == 8.0
    assert [text for _, text in bench.messages] == ["there"]
    at_last_block_ns = next(s.time_ns for s in bench.samples if s.set_mm == (8.0,))
    assert bench.channel.alarm_ns[0] >= at_last_block_ns


def test_what_the_look_ahead_has_found_is_told_when_another_alarm_comes_first(
    channel_bench: Make, words: Any
) -> None:
    def commands() -> Any:
        yield words.move(1, 3000.0, Z=20480.0)
        raise Alarm(900105, reason="division by zero")

    bench = channel_bench(words.axis("Z")).run(commands())
    assert bench.alarm_ids == [900012]
    assert [alarm.id for alarm in bench.channel.further_alarms] == [900105]


@pytest.mark.long
def test_everything_that_comes_up_during_a_stop_is_kept_once(
    channel_bench: Make, words: Any
) -> None:
    """Both drives get into fault in one cycle; the first of the axes has stopped the program."""
    bench = channel_bench(words.axis("Y"), words.axis("Z"))
    bench.prepare([words.move(1, 3000.0, Y=60.0, Z=80.0), words.end()])
    bench.scheduler.run_while(lambda: not bench.samples or bench.set_mm("Y")[-1] < 12.0, 10 * S)
    for axis in ("Y", "Z"):
        bench.nodes[axis].servo.fault(0x4310, 1 << 3, bench.scheduler.now_ns)
    bench.finish()
    assert [(a.id, a.values["axis"]) for a in bench.channel.alarms] == [(900005, "Y")]
    further = [(a.id, a.values["axis"]) for a in bench.channel.further_alarms]
    assert further == [(900005, "Z")]
