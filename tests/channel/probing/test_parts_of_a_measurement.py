"""What a measurement hands on: which axis has its speed, whose lag is not watched, which place."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.probing.test_measurement_by_hand import AXES, BLOCK, SLOPE, Bench, of

from axisrig.kernel.channel.path.measurement import Measurement
from axisrig.kernel.channel.path.stop_way import StopWay
from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings
from axisrig.kernel.measuring.latest_edge import Arrival
from axisrig.kernel.measuring.rules import EXTERNAL, PLC, MeasuringAxis
from axisrig.kernel.measuring.run import Order, RunState
from axisrig.kernel.motion.dynamics import Dynamics
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.probing import LatchTask, ProbingUnit
from axisrig.kernel.time.clock import MS


@pytest.mark.parametrize("moving", [("X", "Z"), ("Z", "X"), ("Z",)])
@pytest.mark.parametrize("named", ["X", "Z"])
def test_a_run_of_type_2_has_the_speed_of_the_first_axis_of_its_block(
    named: str, moving: tuple[str, ...]
) -> None:
    """P-AXIS-00215 of the axis that is programmed, whichever the path moves besides."""
    bench = Bench(X=MeasuringAxis(speed_mm_s=10.0), Z=MeasuringAxis(speed_mm_s=16.0))
    dynamics = Dynamics(SLOPE, SLOPE, SLOPE, 1e3)
    found = bench.measurement.speed_mm_s(2, BLOCK, (named, "Y"), moving, 90.0, dynamics)
    assert found == {"X": 10.0, "Z": 16.0}[named]
    assert bench.measurement.speed_mm_s(1, BLOCK, (named,), moving, 90.0, dynamics) == 90.0


def test_a_speed_at_the_limit_of_the_stroke_is_left_and_not_warned_of() -> None:
    """5 mm at 1000 mm/s²: 100 mm/s."""
    bench = Bench(Z=of(5.0))
    assert bench.speed(4, 100.0) == 100.0
    assert bench.warned == []
    assert bench.speed(4, 100.001) == pytest.approx(100.0)
    assert [warning.id for warning in bench.warned] == [900222]


def test_a_value_that_cannot_be_led_back_is_warned_of_with_the_place_of_its_block() -> None:
    """100 cycles of 1 mm are 100 mm before the begin of the block."""
    bench = Bench(Z=MeasuringAxis(delay_ns=100 * MS))
    port: Any = SimpleNamespace(
        name="Z", is_clear=True, is_armed=True, is_actuated=False, is_prepared=True,
        has_latched=True, latched_mm=0.0, latched_speed_mm=1.0, doubt_mm=None, arrival=Arrival(),
        arm=lambda: None, disarm=lambda: None, is_confirmed=lambda: True,
    )  # fmt: skip
    run = bench.arm(1, "Z", simulated={"Z": port})
    orders = [run.evaluate((6 + k) * MS, k > 2, 8 * MS if k > 2 else None) for k in range(6)]
    assert Order.START in orders
    assert (run.state, run.record.latched_mm) == (RunState.DONE, {})
    (warning,) = bench.warned
    assert (warning.id, warning.place) == (900520, BLOCK.place)


@pytest.mark.parametrize("watches", [False, True])
@pytest.mark.parametrize("moved", [("X",), ("X", "Z"), ("Z",)])
def test_the_lag_of_every_slave_is_left_alone_and_its_stop_is_looked_for_where_it_is_wanted(
    moved: tuple[str, ...], watches: bool
) -> None:
    """Y follows X; P-AXIS-00835 is of the master."""
    stop = FixedStopSettings(lag_limit_mm=1.0, min_time_ns=MS, watches_slaves=watches)
    bench = Bench(**dict.fromkeys(AXES, MeasuringAxis(fixed_stop=stop)))
    for link in bench.links.values():
        link.set_mm = link.actual_mm = 0.0
        link.watches_lag = True
    given: Any = {
        "timing": SimpleNamespace(period_ns=MS, offset_ns=0), "offsets": None, "warn": None,
        "settings": SimpleNamespace(stop_may_be_missing=False),
        "slaves_of": lambda masters: {"Y": "X"} if "X" in masters else {},
        "plc": SimpleNamespace(task=None, axis={}),
    }  # fmt: skip
    measurement = Measurement(bench.clock, bench.path, bench.links, **given)
    motion: Any = SimpleNamespace(travelled_mm=0.0, has_stopped=False)
    run = measurement.arm_stop(moved, StopWay(moved, 10.0), BLOCK, motion)
    with_slave = "X" in moved
    assert run.stop.axes == (*moved, *(("Y",) if with_slave else ()))
    searched = ("Y",) if with_slave and watches else ()
    assert set(run.stop.criteria) == {*moved, *searched}
    assert run.evaluate(6 * MS) is Order.START
    assert [bench.links[axis].watches_lag for axis in AXES] == [
        axis not in run.stop.axes for axis in AXES
    ]
    assert measurement.records == [run.record]


def _switched() -> tuple[Bench, ProbingUnit]:
    unit = ProbingUnit()
    plc = SimpleNamespace(task=SimpleNamespace(), axis={"Z": SimpleNamespace(probing=unit)})
    return Bench(plc=plc, Z=MeasuringAxis(source=EXTERNAL, probe_input=3)), unit


@pytest.mark.parametrize("end", ["end_preparation", "end_program", "reset", "forget"])
def test_a_probe_that_was_prepared_is_switched_off_at_every_end(end: str) -> None:
    bench, unit = _switched()
    measurement = bench.measurement
    measurement.prepare(canon.PrepareProbe(BLOCK, ("Z",)))
    assert (unit.order.task, unit.order.probe_input) == (LatchTask.PREPARE, 3)
    measurement.prepare(canon.PrepareProbe(BLOCK, ("Z",)))  # it is asked for once
    assert (unit.number, len(unit.waiting)) == (1, 0)
    if end == "forget":
        measurement.forget_prepared("Z")
    else:
        getattr(measurement, end)()
    assert [order.task for order in unit.waiting] == [LatchTask.DISABLE]
    assert measurement.prepared == set()
    measurement.end_preparation()  # nothing is prepared any more
    assert len(unit.waiting) == 1


def test_a_probe_of_the_plc_that_nobody_has_used_is_not_known() -> None:
    """None is neither level: the PLC measures and has not given it."""
    bench = Bench(X=MeasuringAxis(source=PLC))
    bench.links["Z"].is_actuated = True
    assert [bench.measurement.is_actuated(axis) for axis in AXES] == [None, False, True]
