"""A gantry against fixed stops: who measures, who is watched, what comes of stops on one side only.

X and X2 are plants of their own, so that nothing but the coupling of the CNC keeps them together.
v feed, Kv of the position loops, L lag limit, tau min_time, F torque limit, k of the stops: a side
at its stop lags v/Kv + v (t - t_contact) - F/k behind its set position.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from axisrig.kernel.channel import Channel

Run = Callable[..., Any]
T_S, KV, WINDOW_MM = 1e-3, 40.0, 0.01  # exact-stop window
LIMIT_N = 0.1 * 2 * np.pi * 9.0 / 0.010  # 10 % of 9 N.m on a screw of 10 mm
PRESSED_MM = LIMIT_N / 20e6 * 1e3
FEED_MM_S, LAG_MM, TAU_S = 10.0, 0.5, 0.1
DETECT = "kenngr.measure.fixed_stop_detect."
SLAVES_TOO = f"set:X.{DETECT}use_gantry_slave=1"
FREE = "plant:x.stop_position_mm=1000"
AWAY = "N100 G1 X125 F1000"
PROGRAM = """\
N10 #SET AX LINK[1, [X2=X,G,15,20]]
N20 #ENABLE AX LINK[1]
N30 #IDENT WR SYN [AXNR 1 ID S-0-0092 VAL=100 TYP 2 DEC 0 SERC]
N40 #IDENT WR SYN [AXNR 4 ID S-0-0092 VAL=100 TYP 2 DEC 0 SERC]
N50 #IDENT WR SYN [AXNR 1 ID S-0-0159 VAL=0 TYP 4 DEC 0 SERC]
N60 #IDENT WR SYN [AXNR 4 ID S-0-0159 VAL=0 TYP 4 DEC 0 SERC]
N70 G100 X200 F600
N80 #MSG SYN["X=%f", V.A.MESS.X]
N90 #MSG SYN["merf=%d", V.A.MERF.X]
"""


@dataclass
class Watch:
    """What the CNC sees of both sides, cycle by cycle."""

    watching: dict[str, list[bool]] = field(default_factory=lambda: {"X": [], "X2": []})
    lag_mm: dict[str, list[float]] = field(default_factory=lambda: {"X": [], "X2": []})
    times_ns: list[int] = field(default_factory=list)

    def __call__(self, channel: Channel) -> None:
        self.times_ns.append(channel.sync_ns + channel.timing.offset_ns)
        for link in channel.links:
            if link.name in self.watching:
                self.watching[link.name].append(link.watches_lag)
                self.lag_mm[link.name].append(link.lag_mm)

    def at(self, time_ns: int) -> int:
        return self.times_ns.index(time_ns)


@pytest.fixture
def gantry(run_nc: Run) -> Callable[..., Any]:
    """Return `run(*assignments, end=...)`: from 125 mm to stops at 130 and 30 mm (X2)."""

    def run(*assignments: str, end: str = "", watch: Watch | None = None) -> Any:
        start = ("plant:x.position_start_mm=125", "plant:x2.position_start_mm=25")
        base = "fixed-stop-gantry.toml"
        return run_nc(f"{PROGRAM}{end}", "", *start, *assignments, base=base, watch=watch)

    return run


def contact_ns(out: Any, axis: str, stop_mm: float) -> float:
    """When the load of an axis has come to a place, from its truth."""
    times, truth = out.column("time_ns"), out.column(f"{axis}.truth_mm")
    behind = int(np.argmax(truth > stop_mm))
    share = (stop_mm - truth[behind - 1]) / (truth[behind] - truth[behind - 1])
    return float(times[behind - 1] + share * (times[behind] - times[behind - 1]))


def stop_of(out: Any) -> Any:
    (record,) = out.machine.channel.records
    assert record.fixed_stop is not None
    return record.fixed_stop


@pytest.mark.long
def test_the_master_measures_and_both_sides_are_relieved(gantry: Run) -> None:
    watch = Watch()
    out = gantry("drive:servo.lag_limit_mm=0.4", watch=watch)
    assert out.alarms == []
    (measured,) = out.printed("X")
    assert measured == pytest.approx(130.0 + PRESSED_MM, abs=0.001)
    stop, (record,) = stop_of(out), out.machine.channel.records
    assert (stop.detected_by, tuple(stop.criteria)) == ("X", ("X",))
    assert record.latched_mm.keys() == {"X"}
    assert stop.actual_mm["X2"] == pytest.approx(30.0 + PRESSED_MM, abs=0.001)
    assert out.column("X2.truth_mm")[-1] == pytest.approx(30.0 + PRESSED_MM, abs=0.001)
    # the lag of both was beyond what the CNC allows, and nobody minded
    off, on = watch.at(stop.watch_off_ns), watch.at(stop.watch_on_ns)
    for axis in ("X", "X2"):
        assert max(watch.lag_mm[axis][off:on]) > LAG_MM
        assert watch.watching[axis][off - 1] is True
        assert set(watch.watching[axis][off:on]) == {False}
        assert set(watch.watching[axis][on:]) == {True}
        assert abs(watch.lag_mm[axis][on]) < 0.01


@pytest.mark.long
@pytest.mark.parametrize(("stop_mm", "start_mm"), [(29.95, 25.0), (30.05, 25.0), (20.0, 17.0)])
def test_stops_that_are_not_in_line_leave_the_slave_its_difference(
    gantry: Run, stop_mm: float, start_mm: float
) -> None:
    """A slave that its stop holds back does not keep the run from its end.

    It is pressed against its stop when that is nearer than the master's. Behind it the slave comes
    to rest within its exact-stop window of the place beside its master.
    """
    out = gantry(
        f"plant:x2.stop_position_mm={stop_mm}",
        f"plant:x2.position_start_mm={start_mm}",
        end=AWAY,
    )
    assert out.alarms == []
    assert out.printed("X") == [pytest.approx(130.0 + PRESSED_MM, abs=0.001)]
    beside_mm, stand_mm = start_mm + 5.0 + PRESSED_MM, out.stand_mm("X2")
    if stop_mm + PRESSED_MM < beside_mm:
        assert stand_mm == pytest.approx(stop_mm + PRESSED_MM, abs=0.001)
    else:
        assert stand_mm == pytest.approx(beside_mm, abs=WINDOW_MM)
    assert out.column("X2.truth_mm")[-1] == pytest.approx(start_mm, abs=0.01)


@pytest.mark.long
def test_a_stop_of_the_slave_alone_ends_at_the_limit_of_the_gantry(gantry: Run) -> None:
    """Nobody looks at the slave: the sides part by v (t - t_contact) - F/k up to 15 mm."""
    watch = Watch()
    out = gantry(FREE, watch=watch)
    assert out.alarms == [900192]
    (alarm_ns,) = out.machine.channel.alarm_ns
    predicted_s = (15.0 + PRESSED_MM) / FEED_MM_S
    taken_s = (alarm_ns - contact_ns(out, "X2", 30.0)) * 1e-9
    assert 0 <= taken_s - predicted_s <= 2 * T_S
    (alarm,) = out.machine.channel.alarms
    assert float(alarm.values["difference_mm"]) == pytest.approx(-15.0, abs=2 * FEED_MM_S * T_S)
    assert out.machine.channel.records[0].latched_mm == {}
    assert [watch.watching[axis][-1] for axis in ("X", "X2")] == [True, True]


@pytest.mark.long
@pytest.mark.parametrize("lag_mm", [0.5, 0.35, 1.5])
def test_with_p_axis_00835_the_stop_of_the_slave_is_found(gantry: Run, lag_mm: float) -> None:
    """By the criteria of the slave; the value is where the master has come to meanwhile."""
    out = gantry(FREE, SLAVES_TOO, f"set:X2.{DETECT}pos_lag_limit={lag_mm * 1e4:.0f}", end=AWAY)
    assert out.alarms == []
    stop = stop_of(out)
    assert (stop.detected_by, set(stop.criteria)) == ("X2", {"X", "X2"})
    beyond_mm = lag_mm - FEED_MM_S / KV + PRESSED_MM
    contact = contact_ns(out, "X2", 30.0)
    taken_s = (stop.detected_ns - contact) * 1e-9
    assert 0 <= taken_s - (beyond_mm / FEED_MM_S + TAU_S) <= 2 * T_S
    (measured,) = out.printed("X")
    assert measured == pytest.approx(130.0 + FEED_MM_S * taken_s, abs=FEED_MM_S * 2 * T_S)
    # the master goes to its own place; the slave stays at its stop, pressed with the limit
    assert out.stand_mm("X") == pytest.approx(measured, abs=WINDOW_MM)
    assert out.stand_mm("X2") == pytest.approx(30.0 + PRESSED_MM, abs=0.001)


@pytest.mark.long
@pytest.mark.provokes(70082, 5, axis="X2")
def test_70082_when_the_program_waits_with_the_slave_still_at_its_stop(gantry: Run) -> None:
    """The end of a program is an exact stop of all axes."""
    assert gantry(FREE, SLAVES_TOO).alarms == [70082]


@pytest.mark.long
def test_either_side_may_be_first(gantry: Run) -> None:
    """Stops in line: the side with the smaller limit is first, the value is the master's."""
    out = gantry(SLAVES_TOO, f"set:X2.{DETECT}pos_lag_limit=3500")
    stop = stop_of(out)
    assert stop.detected_by == "X2"
    assert out.printed("X") == [pytest.approx(130.0 + PRESSED_MM, abs=0.001)]


@pytest.mark.long
def test_a_slave_that_is_still_held_back_is_monitored_from_the_end_of_the_run_on(
    gantry: Run,
) -> None:
    out = gantry(FREE, SLAVES_TOO, "drive:servo.lag_limit_mm=0.4")
    assert out.alarms == [900036]
    (record,) = out.machine.channel.records
    (alarm_ns,) = out.machine.channel.alarm_ns
    assert 0 <= alarm_ns - record.end_ns <= 1_000_000
    assert record.latched_mm.keys() == {"X"}


@pytest.mark.long
def test_arming_takes_the_smallest_way_of_all_that_are_watched(gantry: Run) -> None:
    early = gantry(SLAVES_TOO, *_arming(X=40000, X2=20000))
    late = gantry(*_arming(X=40000, X2=20000))
    assert stop_of(early).start_distance_mm == 2.0
    assert stop_of(late).start_distance_mm == 4.0


def _arming(**ways: int) -> list[str]:
    return [f"set:{axis}.{DETECT}start_distance={way}" for axis, way in ways.items()]
