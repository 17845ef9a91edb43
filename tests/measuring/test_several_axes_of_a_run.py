"""Runs of two axes, and values at the edges of what counts: the second one, the other direction."""

from typing import Any

import pytest
from tests.measuring.fake_latch import MS, FakeLatch, Stage

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.dead_time import DeadTime
from axisrig.kernel.measuring.latest_edge import Arrival, LatestEdge, StampClock
from axisrig.kernel.measuring.position_history import PositionHistory
from axisrig.kernel.measuring.rules import lengthened
from axisrig.kernel.measuring.run import MeasuringRun, RunState
from axisrig.kernel.measuring.simulated import towards


def dead(axis: str, lag_mm: float = 0.0, **more: Any) -> DeadTime:
    """Two cycles late; 1 um of window."""
    given = {"cycles": 2.0, "begin_mm": 0.0, "window_mm": 0.001} | more
    return DeadTime(axis, behind_mm=lambda _mm: 0.0, lag_mm=lambda: lag_mm, **given)


def run_of(
    ports: tuple[FakeLatch, ...], *dead_times: DeadTime, error: bool = False
) -> tuple[Stage, list[Alarm]]:
    warned: list[Alarm] = []
    stage = Stage(*ports)
    stage.run = MeasuringRun(
        ports, "N20", 0, error, dead_times={d.axis: d for d in dead_times}, warn=warned.append
    )
    return stage.move(), warned


@pytest.mark.parametrize("lags_mm", [(0.25, 0.25), (0.25, 0.0), (0.0, -0.25), (0.0, 0.0)])
def test_each_axis_has_the_room_of_its_own_lag_at_the_signal(lags_mm: tuple[float, float]) -> None:
    """0.75 mm from the begin, two cycles at 0.5 mm back: 0.25 mm too far without a lag."""
    ports = FakeLatch("X", latched_speed_mm=0.5), FakeLatch("Y", latched_speed_mm=0.5)
    stage, warned = run_of(ports, *map(dead, "XY", lags_mm))
    for port in ports:
        port.latch(0.75)
    stage.cycles(3, standing=True)
    expected = {axis: -0.25 for axis, lag in zip("XY", lags_mm, strict=True) if lag}
    assert stage.run.record.latched_mm == expected
    refused = [axis for axis in "XY" if axis not in expected]
    assert [(alarm.id, alarm.values["axis"]) for alarm in warned] == [
        (900520, axis) for axis in refused
    ]


def test_a_value_before_the_block_says_where_it_would_be_and_how_far_before() -> None:
    """Begin at 10 mm: a latch at 10.75 mm less 1 mm is 9.75 mm, a quarter before it."""
    for sign in (1.0, -1.0):
        port = FakeLatch("Z", latched_speed_mm=sign * 0.5)
        stage, warned = run_of((port,), dead("Z", begin_mm=sign * 10.0))
        port.latch(sign * 10.75)
        stage.cycles(3, standing=True)
        (alarm,) = warned
        assert alarm.values == {
            "axis": "Z", "value_mm": f"{sign * 9.75:g}", "before_mm": "0.25",
            "begin_mm": f"{sign * 10.0:g}",
        }  # fmt: skip


@pytest.mark.parametrize("wants", [True, False])
def test_a_dropped_value_of_one_axis_is_a_missing_signal_where_one_is_wanted(wants: bool) -> None:
    """The other axis has its value; only the axes without one are named, in their order."""
    ports = tuple(FakeLatch(name, latched_speed_mm=0.5) for name in ("Y", "Z", "X"))
    stage, warned = run_of(ports, dead("Y"), dead("X"), error=wants)
    for port in ports:
        port.latch(0.75)
    if not wants:
        stage.cycles(3, standing=True)
        assert (stage.run.is_done, stage.run.record.latched_mm) == (True, {"Z": 0.75})
        assert not stage.run.record.has_signal
    else:
        with pytest.raises(Alarm) as caught:
            stage.cycles(3, standing=True)
        assert (caught.value.id, caught.value.values["axis"]) == (900004, "X Y")
    assert [alarm.values["axis"] for alarm in warned] == ["Y", "X"]


@pytest.mark.parametrize("first_delay", [0, 3])
def test_an_edge_may_still_be_reported_by_any_axis(first_delay: int) -> None:
    """One status is as old as its cycle, the other three cycles: its edge comes two after rest."""
    delays = (first_delay, 3 - first_delay)
    ports = tuple(
        FakeLatch(name, arrival=Arrival(delay_cycles=delay))
        for name, delay in zip("XY", delays, strict=True)
    )
    late = ports[delays.index(3)]
    stage, _ = run_of(ports)
    stage.cycle()
    stage.cycles(2, standing=True)
    assert stage.run.state is RunState.COLLECTING
    late.latch(4.0)
    with pytest.raises(Alarm) as caught:
        stage.cycles(6, standing=True)
    silent = ports[1 - delays.index(3)]
    assert caught.value.id == 900003
    assert (caught.value.values["axis"], caught.value.values["others"]) == (silent.name, late.name)


# Stamps


@pytest.mark.parametrize(("before_ns", "counts"), [(0, True), (-1, True), (1, False)])
def test_a_stamp_at_the_begin_of_its_run_is_one_of_it(before_ns: int, counts: bool) -> None:
    """Before it it is still that of an earlier run."""
    begin_ns = 20 * MS
    arrival = Arrival(0, 3, StampClock(), stamp=begin_ns - before_ns)
    edge = LatestEdge(FakeLatch(has_latched=True, latched_mm=1.0, arrival=arrival), begin_ns)
    edge.look(begin_ns + 5 * MS, begin_ns + 5 * MS)
    assert (edge.counts, edge.is_over) == (counts, False)


@pytest.mark.parametrize(("late_ns", "counts"), [(0, True), (1, False)])
def test_a_stamp_at_the_rest_of_the_axes_still_counts(late_ns: int, counts: bool) -> None:
    arrival = Arrival(0, 3, StampClock(sync_ns=500), stamp=30 * MS + 500 + late_ns)
    edge = LatestEdge(FakeLatch(has_latched=True, latched_mm=1.0, arrival=arrival), 0)
    edge.look(35 * MS, 30 * MS)
    assert (edge.counts, edge.is_over) == (counts, not counts)


# Ways and places


@pytest.mark.parametrize(
    ("target", "overtravel_mm", "found"),
    [
        ({"Y": -30.0, "Z": -40.0}, {"Y": 3.0, "Z": 2.0}, {"Y": -31.5, "Z": -42.0}),
        ({"Y": 30.0, "Z": -40.0}, {"Y": 3.0, "Z": 2.0}, {"Y": 31.5, "Z": -42.0}),
        ({"Y": -30.0, "Z": 40.0}, {"Y": 1.5, "Z": 9.0}, {"Y": -31.5, "Z": 42.0}),
        ({"Y": 0.0, "Z": -40.0}, {"Y": 0.0, "Z": 2.0}, {"Y": 0.0, "Z": -42.0}),
        ({"Y": -30.0, "Z": -40.0}, {"Y": 0.0, "Z": 2.0}, {"Y": -30.0, "Z": -40.0}),
    ],
)
def test_a_path_goes_on_in_its_own_direction(
    target: dict[str, float], overtravel_mm: dict[str, float], found: dict[str, float]
) -> None:
    """30 and 40 mm: a twentieth more is what the strictest axis allows."""
    here = {"Y": 0.0, "Z": 0.0}
    assert lengthened(here, target, overtravel_mm) == pytest.approx(found)


@pytest.mark.parametrize(("missing", "sign"), [(3, 1.0), (3, -1.0), (5, 1.0)])
def test_the_doubt_in_a_gap_counts_the_way_of_the_cubic_from_the_line(
    missing: int, sign: float
) -> None:
    """x = a t²/2 over a gap h: the line is a h²/8 beside it, and as much again is the bound."""
    a_mm_s2, gap_s = 1000.0, 2e-3
    history = PositionHistory()
    for number in range(10):
        if number != missing:
            t_s = number * 1e-3
            history.take(number * MS, sign * 0.5 * a_mm_s2 * t_s * t_s)
    doubt_mm = history.doubt_mm(missing * MS, MS, a_mm_s2)
    assert doubt_mm == pytest.approx(2.0 * a_mm_s2 * gap_s**2 / 8.0, rel=1e-6)
    # without a bound: what the neighbours are away at most
    t_s = missing * 1e-3
    way_mm = 0.5 * a_mm_s2 * ((t_s + 1e-3) ** 2 - t_s**2)
    assert history.doubt_mm(missing * MS, MS) == pytest.approx(way_mm, rel=1e-6)
    assert history.doubt_mm((missing + 2) * MS, MS) == 0.0


@pytest.mark.parametrize(
    ("places_mm", "position_mm", "way"),
    [
        ((5.0, 5.0), 7.0, 1.0), ((5.0, 5.0 - 1e-12), 7.0, 1.0), ((5.0, 4.9), 7.0, -1.0),
        ((5.0, 4.9), 3.0, -1.0), ((5.0, 5.1), 3.0, 1.0), ((5.0, 8.0, 2.0), 7.0, 1.0),
        ((5.0, 8.0, 2.0), 3.0, -1.0), ((5.0, 8.0, 2.0), 5.0, -1.0), ((5.0, 2.0, 8.0), 5.0, 1.0),
        ((5.0, 8.0, 2.0), 8.0, 1.0), ((5.0, 8.0, 2.0), 2.0, -1.0), ((5.0, 8.0, 2.0), 8.1, -1.0),
    ],
)  # fmt: skip
def test_an_axis_that_stands_but_for_rounding_has_no_way_down(
    places_mm: tuple[float, ...], position_mm: float, way: float
) -> None:
    """At its start a position is that of the path as a whole; elsewhere of the first time."""
    assert towards(places_mm, position_mm) == way
