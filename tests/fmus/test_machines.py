"""Axis and sensor in one FMU: any master steps them, with what the bench makes of two FMUs."""

from collections.abc import Callable

import pytest
from fmpy.fmi3 import FMU3Slave

from axisrig.fmus import BuildError, ensure_built
from axisrig.fmus.build import build
from axisrig.kernel.cosim.fmi.fmu import load_fmu
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.time.clock import MS

PROBE_ON_AXIS = "AxisRig.Machines.ProbeOnAxis"
SENSOR_ON_AXIS = "AxisRig.Machines.DistanceSensorOnAxis"
AXIS = {"position_start": 0.102, "kv": 40.0}
PROBE = {"surface": 0.1, "ball_radius": 1e-3, "pretravel": 5e-6, "trigger_delay": 0.3e-3}
SENSOR = {"range": 5e-3, "order": 2, "bandwidth": 200.0, "workpiece.plane.level": 0.1}
FEED = 0.02
PLACE_M = 1e-12  # 1e-12 of a metre, the range of a large axis
EDGE_S = 2e-9  # the bench holds edges as whole nanoseconds


def down_and_up(fmu, feed: float, begin: float = 0.0, place: float = 0.102) -> None:
    """Demand from now on: this slope, without an end."""
    fmu.set(reference_position=place, reference_velocity=feed, reference_time=begin)
    fmu.set(reference_end=1e3, enabled=True)


def within(name: str, values: dict[str, float]) -> dict[str, float]:
    return {f"{name}.{key}": value for key, value in values.items()}


@pytest.mark.parametrize("step_ms", [1.0, 0.25, 10.0])
def test_probe_on_axis_is_axis_and_probe_of_the_bench(step_ms, load):
    """fmpy as the master of one FMU, the bench's stepping of two: same place, same edges."""
    plant = Plant(20 * MS)
    axis, probe = (
        load_fmu(ensure_built(model), name)
        for model, name in (
            ("AxisRig.Drives.ServoAxis", "z"),
            ("AxisRig.Sensors.TouchProbe", "probe"),
        )
    )
    for slave, start in ((axis, AXIS), (probe, PROBE)):
        for key, value in start.items():
            slave.set_start(key, value)
    try:
        plant.add_axis(axis)
        plant.add_probe(probe, {"z": "z"})
        plant.initialize(0)
        one = load(PROBE_ON_AXIS, **AXIS, **within("probe", PROBE))
        for leg, (feed, place) in enumerate(((-FEED, 0.102), (FEED, 0.1))):
            begin_ns = leg * 100 * MS
            plant.axes["z"].command(begin_ns, place, feed, 1000 * 1000 * MS, True)
            down_and_up(one, feed, begin_ns * 1e-9, place)
            for number in range(round(100 / step_ms)):
                end_ns = begin_ns + round((number + 1) * step_ms * MS)
                plant.advance_to(end_ns)
                one.step_to(end_ns * 1e-9)
                assert one.position == pytest.approx(plant.axes["z"].position_m(), abs=PLACE_M)
        edges = plant.probes["probe"].signal.edges
        assert [level for _, level in edges] == [True, False]
        assert one.rising_time == pytest.approx(edges[0][0] * 1e-9, abs=EDGE_S)
        assert one.falling_time == pytest.approx(edges[1][0] * 1e-9, abs=EDGE_S)
        assert (one.rising_count, one.falling_count) == (1, 1)
    finally:
        plant.close()


def test_distance_sensor_on_axis_is_axis_and_sensor(load):
    """The sensor of its own gets each step of 50 us of the axis of its own."""
    axis = load("AxisRig.Drives.ServoAxis", **AXIS)
    apart = load("AxisRig.Sensors.DistanceSensor", **SENSOR, z_start=0.102, z_end=0.102)
    one = load(SENSOR_ON_AXIS, **AXIS, **within("sensor", SENSOR))
    for fmu in (axis, one):
        down_and_up(fmu, -FEED)
    for number in range(1, 3001):
        begin, end = (number - 1) * 50e-6, number * 50e-6
        start, rate = axis.position, axis.velocity
        axis.step_to(end)
        apart.set(step_time=begin, step_size=end - begin, z_start=start, z_rate_start=rate)
        apart.set(z_end=axis.position, z_rate_end=axis.velocity)
        apart.step_to(end)
        if number % 20 == 0:
            one.step_to(end)
            assert one.position == pytest.approx(axis.position, abs=PLACE_M)
            assert one.distance_true == pytest.approx(apart.distance_true, abs=PLACE_M)
            assert one.distance == pytest.approx(apart.distance, abs=1e-10)  # filter over cubics
            assert (one.valid, one.touching) == (apart.valid, apart.touching)
            assert one.touch_count == apart.touch_count
    assert one.touch_count == 1
    assert one.touch_time == pytest.approx(apart.touch_time, abs=1e-9)


class Early:
    """An instance that may return early."""

    def __init__(self, load: Callable, is_allowed: bool) -> None:
        self.fmu = load(PROBE_ON_AXIS, **AXIS, **within("probe", PROBE))
        slave = self.fmu.slave
        slave.fmi3FreeInstance(slave.component)
        slave.instantiate(earlyReturnAllowed=is_allowed)
        self.fmu.start(**AXIS, **within("probe", PROBE))
        down_and_up(self.fmu, -FEED)

    def step_to(self, end: float) -> tuple[bool, float]:
        """Step once; whether it has returned early, and where it is."""
        done = self.fmu.slave.doStep(self.fmu.time, end - self.fmu.time)
        self.fmu.time = done[3]
        return done[2], done[3]


def test_a_step_ends_at_the_edge_where_the_importer_allows_it(load):
    early, whole = Early(load, True), Early(load, False)
    assert early.fmu.description.coSimulation.mightReturnEarlyFromDoStep
    assert isinstance(early.fmu.slave, FMU3Slave)
    has_returned, instant = early.step_to(0.2)
    assert has_returned
    assert instant == early.fmu.rising_time
    assert early.fmu.signal is True
    assert early.step_to(0.2) == (False, 0.2)
    assert whole.step_to(0.2) == (False, 0.2)
    assert whole.fmu.rising_time == pytest.approx(instant, abs=1e-10)
    assert whole.fmu.position == pytest.approx(early.fmu.position, abs=PLACE_M)
    assert whole.fmu.edge_position == pytest.approx(early.fmu.edge_position, abs=PLACE_M)


def test_an_output_that_is_no_level_cannot_end_a_step(tmp_path):
    model = tmp_path / "Odd.mo"
    model.write_text(
        "model Odd\n  output Real y;\nequation\n  y = time;\n"
        '  annotation(__axisrig(returns_early = "y"));\nend Odd;\n'
    )
    with pytest.raises(BuildError, match="returns_early: y is no Boolean output"):
        build("Odd", tmp_path / "Odd.fmu", model)
