"""Values and words at the edges of what a run, a history and the rules of the types say."""

import pytest
from tests.measuring.fake_latch import MS, FakeLatch, Stage, next_alarm

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.dead_time import run_up
from axisrig.kernel.measuring.latest_edge import Arrival, LatestEdge, StampClock
from axisrig.kernel.measuring.position_history import PositionHistory
from axisrig.kernel.measuring.rules import MeasuringAxis
from axisrig.kernel.motion.jerk import JerkSlope
from axisrig.kernel.motion.jerk_ramps import Shape
from axisrig.kernel.motion.profile import Slope
from axisrig.kernel.nc.measuring_types import measuring_types
from axisrig.kernel.parameters.signal_sources import SOURCES


@pytest.mark.parametrize(("first_ms", "then_ms", "edge_ms"), [(4, 9, 6), (4, None, 6), (9, 9, 6)])
def test_axes_that_move_again_come_to_rest_later(
    first_ms: int, then_ms: int | None, edge_ms: int
) -> None:
    """They are pushed on; an edge of 6 ms is reported in the cycle of 12 ms."""
    port = FakeLatch(arrival=Arrival(20, 0, StampClock(1, 0, 0)))
    run = Stage(port).move().run
    run.evaluate(10 * MS, False, first_ms * MS)
    run.evaluate(11 * MS, False, None)
    port.latch(1.5)
    port.arrival.stamp = edge_ms * MS
    run.evaluate(12 * MS, False, None if then_ms is None else then_ms * MS)
    assert run.record.signal_ns == 12 * MS


@pytest.mark.parametrize("silent", ["X", "Y", "Z", "XZ", "YZ"])
def test_each_axis_with_and_without_a_signal_is_named(silent: str) -> None:
    ports = [FakeLatch(name) for name in "XYZ"]
    stage = Stage(*ports).move()
    for port in ports:
        if port.name not in silent:
            port.latch(1.0)
    alarm, _ = next_alarm(stage, 30, standing=True)
    assert alarm.id == 900003
    assert alarm.values["axis"] == " ".join(silent)
    assert alarm.values["others"] == " ".join(name for name in "XYZ" if name not in silent)


@pytest.mark.parametrize("speed_mm_s", [1e-3, 0.5, 0.999, 20.0])
def test_a_run_up_takes_its_time_and_way_however_slow_it_is(speed_mm_s: float) -> None:
    """v/a and v²/2a; with ramps of t and a speed below a t, 2 sqrt(v t/a) and half of v times it.

    The speed counts as reached a millionth below it: with a ramp of SIN2 of the time t the last
    third root of 12e-6/pi², 0.0107 t, is left out, of 2 t; of the way that is twice the share.
    """
    linear = Slope(1000.0, 1000.0, 100.0)
    time_s, way_mm = run_up(linear, linear, speed_mm_s)
    assert time_s == pytest.approx(speed_mm_s / 1000.0, rel=1e-5)
    assert way_mm == pytest.approx(speed_mm_s**2 / 2000.0, rel=1e-5)
    for shape in Shape:
        ramps = JerkSlope(1000.0, 0.05, 0.05, shape)
        time_s, way_mm = run_up(ramps, ramps, speed_mm_s)
        whole_s = 2.0 * (speed_mm_s * 0.05 / 1000.0) ** 0.5
        assert time_s == pytest.approx(whole_s, rel=0.006)
        assert way_mm == pytest.approx(0.5 * speed_mm_s * whole_s, rel=0.012)
    assert run_up(linear, linear, 0.0) == (0.0, 0.0)


@pytest.mark.parametrize("share", [0.1, 0.25, 0.5, 0.9])
@pytest.mark.parametrize("a_mm_s2", [1000.0, -1000.0])
def test_the_doubt_beside_a_missing_sample_is_the_bow_of_an_acceleration_and_that_of_the_value(
    share: float, a_mm_s2: float
) -> None:
    """h = 2 ms: a h²/8 of any motion, and a (t - t0)(t1 - t)/2 that the known one is off the line.

    Fast enough that the samples on both sides are farther away.
    """
    history = PositionHistory()
    for number in (0, 1, 2, 4, 5, 6):
        t_s = number * 1e-3
        history.take(number * MS, 100.0 * t_s + 0.5 * a_mm_s2 * t_s * t_s)
    at_ns = round((2 + 2 * share) * MS)
    bow_mm = 500.0 * (2e-3) ** 2 / 8.0
    off_mm = 0.5 * abs(a_mm_s2) * share * (1.0 - share) * (2e-3) ** 2
    assert history.doubt_mm(at_ns, MS, 500.0) == pytest.approx(bow_mm + off_mm, rel=1e-6)


@pytest.mark.parametrize(("clock", "stamp"), [(True, None), (False, 5), (True, 5), (False, None)])
def test_telegrams_that_stay_out_are_waited_for_where_the_time_of_a_latch_can_be_found(
    clock: bool, stamp: int | None
) -> None:
    """Delay 2 and 3 missing ones at most: with a clock and a stamp the fifth one decides."""
    arrival = Arrival(2, 3, StampClock() if clock else None, stamp=stamp)
    edge = LatestEdge(FakeLatch(arrival=arrival), 0)
    assert arrival.is_stamped is (clock and stamp is not None)
    looks = 0
    while edge.is_open:
        edge.look((10 + looks) * MS, 10 * MS)
        looks += 1
    assert looks == 1 + 2 + (3 if clock and stamp is not None else 0)


def test_an_edge_waits_for_its_stamp_no_longer_than_it_is_open() -> None:
    port = FakeLatch(arrival=Arrival(0, 0, StampClock(), stamp=0))
    edge = LatestEdge(port, 5 * MS)
    assert not edge.waits_for_stamp
    port.latch(1.0)  # the stamp is still the one before
    edge.look(10 * MS, 8 * MS)
    assert edge.waits_for_stamp
    port.arrival.stamp = 7 * MS
    edge.look(11 * MS, 8 * MS)
    assert edge.counts
    assert not edge.waits_for_stamp
    assert port.has_latched


@pytest.mark.parametrize(
    ("number", "is_beside", "where"),
    [
        (1, True, "beside the path"),
        (7, True, "in a run to a fixed stop"),
        (7, False, "in a run to a fixed stop"),
        (1, False, None),
    ],
)
def test_where_a_simulated_probe_cannot_be_is_named(
    number: int, is_beside: bool, where: str | None
) -> None:
    axis, kind = MeasuringAxis(simulated=(2, 5, 0, 0, 0)), measuring_types()[number]
    if where is None:
        axis.check("Z", kind, "DRIVE", is_beside=is_beside)
        return
    with pytest.raises(Alarm) as refused:
        axis.check("Z", kind, "FIXED_STOP", is_beside=is_beside)
    assert refused.value.id == 900100
    assert refused.value.values["what"] == f"simulated probe {where}"
    assert refused.value.values["word"] == "meas_simu.meas_simu_mode = 2 of axis Z"


def test_a_source_without_an_input_takes_either_number() -> None:
    without = [
        name for name, source in SOURCES.items() if MeasuringAxis().drive.inputs_of(name) is None
    ]
    assert "FIXED_STOP" in without
    assert all(SOURCES[name].inputs is None for name in without)
    assert [MeasuringAxis().inputs_of(name) for name in without] == [2] * len(without)
