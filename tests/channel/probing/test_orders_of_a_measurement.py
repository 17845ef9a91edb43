"""How a run is ordered from its block: speed, end, simulated probes, stops at slaves, way back."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.probing.test_measurement_by_hand import BLOCK, SLOPE, Bench

from axisrig.kernel.channel.path.measurement import Measurement
from axisrig.kernel.channel.path.stop_way import StopWay
from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.fixed_stop.settings import FixedStopSettings
from axisrig.kernel.measuring.rules import MeasuringAxis
from axisrig.kernel.measuring.run import Order, RunState
from axisrig.kernel.motion.dynamics import Dynamics, Motion
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import MS

RAPID_MM_S, MEASURING_MM_S = 200.0, 90.0


def run_of(bench: Bench, **changes: Any) -> canon.MeasuringRun:
    """A block that moves Z, on a path with the speeds of rapid traverse and of measuring."""
    given: dict[str, Any] = {"feed_mm_min": 600.0, "measuring_type": 1} | changes
    speeds = {Motion.RAPID: RAPID_MM_S, Motion.MEASURING: MEASURING_MM_S}

    def dynamics(_target: Any, motion: Motion, *, overtravel_mm: Any) -> Dynamics:
        return Dynamics(SLOPE, SLOPE, SLOPE, speeds[motion])

    bench.path.dynamics = dynamics
    bench.path.transformation = SimpleNamespace(kinematic=None)
    return canon.MeasuringRun(BLOCK, {"Z": 10.0}, ("Z",), ("Z",), **given)


def begun(bench: Bench, **changes: Any) -> Any:
    bench.measurement.begin(run_of(bench, **changes))
    parts: Any = bench.measurement
    return parts


@pytest.mark.parametrize(
    ("feed_mm_min", "speed_mm_s"), [(600.0, 10.0), (60_000.0, MEASURING_MM_S), (None, 90.0)]
)
def test_a_run_has_the_speed_of_its_block_and_no_more_than_it_may(
    feed_mm_min: float | None, speed_mm_s: float
) -> None:
    """G310 with G0 asks for rapid traverse, which its own dynamics cut."""
    assert begun(Bench(), feed_mm_min=feed_mm_min)._order.speed_mm_s == speed_mm_s


def test_what_rapid_traverse_asks_for_is_named_where_the_stroke_lowers_it() -> None:
    """Type 4: 0.5 mm at 1000 mm/s² are 31.6 mm/s, of 200 mm/s of rapid traverse."""
    bench = Bench(Z=MeasuringAxis(stroke_mm=0.5))
    order = begun(bench, feed_mm_min=None, measuring_type=4)._order
    assert order.speed_mm_s == pytest.approx(1000.0**0.5)
    (warning,) = bench.warned
    assert (warning.id, warning.values["speed_mm_min"]) == (900222, f"{RAPID_MM_S * 60:g}")
    assert order.dynamics.speed_max_mm_s == pytest.approx(1000.0**0.5)


@pytest.mark.parametrize("goes_on", [True, False])
@pytest.mark.parametrize("error_no_signal", [True, False, None])
def test_what_the_block_wants_of_its_signal_is_in_its_run(
    goes_on: bool, error_no_signal: bool | None
) -> None:
    bench = Bench()
    run = begun(bench, goes_on=goes_on, error_no_signal=error_no_signal, measuring_type=3)._run
    assert run.record.goes_on is goes_on
    assert bench.measurement.records == [run.record]


@pytest.mark.parametrize("axis", ["X", "Z"])
def test_every_axis_of_the_block_and_of_the_measurement_is_checked(axis: str) -> None:
    """Those that must signal need not be named, as under #CS."""
    bench = Bench()
    bench.may_measure[axis] = False
    command = run_of(bench)
    wider = canon.MeasuringRun(BLOCK, command.target_mm, ("Z",), ("X", "Z"), 600.0, 1)
    with pytest.raises(Alarm) as refused:
        bench.measurement.begin(wider)
    assert (refused.value.id, refused.value.values["axis"]) == (50059, axis)
    assert not bench.measurement.is_active


@pytest.mark.parametrize("state", RunState)
def test_a_simulated_probe_sees_the_cycles_of_the_motion_alone(state: RunState) -> None:
    bench = Bench()
    bench.path.is_in_position, bench.path.has_stopped = (lambda: False), False
    parts: Any = bench.measurement
    looks: list[int] = []
    parts._simulated = SimpleNamespace(look=lambda: looks.append(1))
    run = SimpleNamespace(state=state, evaluate=lambda *_any: Order.NONE)
    assert parts._evaluate(run) is Order.NONE
    assert len(looks) == (1 if state is RunState.MOVING else 0)


@pytest.mark.parametrize(
    ("of_master", "of_slave"), [(True, False), (False, True), (True, True), (False, False)]
)
@pytest.mark.parametrize("may_be_missing", [True, False])
def test_the_master_of_a_gantry_decides_about_its_slaves_and_the_channel_about_a_missing_stop(
    of_master: bool, of_slave: bool, may_be_missing: bool
) -> None:
    """P-AXIS-00835 and P-CHAN-00266: Y follows X."""
    lists = {
        name: MeasuringAxis(
            fixed_stop=FixedStopSettings(lag_limit_mm=1.0, min_time_ns=MS, watches_slaves=watches)
        )
        for name, watches in (("X", of_master), ("Y", of_slave), ("Z", True))
    }
    bench = Bench(**lists)
    for link in bench.links.values():
        link.set_mm = link.actual_mm = 0.0
        link.watches_lag = True
    given: Any = {
        "timing": SimpleNamespace(period_ns=MS, offset_ns=0), "offsets": None, "warn": None,
        "settings": SimpleNamespace(stop_may_be_missing=may_be_missing),
        "slaves_of": lambda masters: {"Y": "X"} if "X" in masters else {},
        "plc": SimpleNamespace(task=None, axis={}),
    }  # fmt: skip
    measurement = Measurement(bench.clock, bench.path, bench.links, **given)
    motion: Any = SimpleNamespace(travelled_mm=0.0, has_stopped=True)
    run = measurement.arm_stop(("X",), StopWay(("X",), 10.0), BLOCK, motion)
    assert set(run.stop.criteria) == ({"X", "Y"} if of_master else {"X"})
    assert run._plan.is_error is not may_be_missing


@pytest.mark.parametrize("superposed_mm", [0.0, 1.5, -0.25])
def test_axes_are_led_back_without_what_distance_control_superposes(superposed_mm: float) -> None:
    """The place at the stop is with it; what the path has is without."""
    bench = Bench()
    led: list[tuple[dict[str, float], float]] = []
    bench.path.superposed_mm = lambda axis: superposed_mm if axis == "Z" else 0.0
    bench.path.lead_back = lambda targets_mm, mm_s: led.append((targets_mm, mm_s))
    parts: Any = bench.measurement
    parts._relax({"X": 3.0, "Z": 7.0}, 4.0)
    assert led == [({"X": 3.0, "Z": 7.0 - superposed_mm}, 4.0)]
