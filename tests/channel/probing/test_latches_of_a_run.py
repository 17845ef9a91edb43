"""Which latch each axis of a run measures with: in its drive, at the PLC, or a simulated one."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.channel.probing.test_measurement_by_hand import Bench

from axisrig.kernel.errors import Alarm
from axisrig.kernel.measuring.rules import (
    EXTERNAL,
    EXTERNAL_WITH_DRIVE,
    PLC,
    PLC_FIRST_EVENT,
    PLC_TIMESTAMP,
    MeasuringAxis,
)
from axisrig.kernel.measuring.run import RunState
from axisrig.kernel.measuring.simulated import CYCLES, SimulatedProbe, Way
from axisrig.kernel.plc.probing import AxisWrites, LatchTask, PlcTask, ProbingUnit
from axisrig.kernel.time.clock import MS

AXES = ("X", "Y", "Z")
OF_DRIVE = ("DRIVE", "DRIVE_TYPE_DEFAULT")
AT_PLC = (PLC, PLC_FIRST_EVENT, PLC_TIMESTAMP, EXTERNAL, EXTERNAL_WITH_DRIVE)
SWITCHED = (EXTERNAL, EXTERNAL_WITH_DRIVE)
"""Sources whose probe or hardware the PLC switches on and off."""
MADE_MM = 77.0


class Rig:
    """Axes over drives with a task of the PLC; an axis stands at 10 mm times its place and cycle.

    simulated: axes whose lists have mode 2, so many cycles after the motion began.
    """

    def __init__(self, sources: dict[str, str], simulated: tuple[str, ...] = ()) -> None:
        self.units = {name: ProbingUnit() for name in AXES}
        self.task = PlcTask(cycle_ns=MS, watchdog_ns=50 * MS, acknowledge_ns=50 * MS)
        at_plc = {name: SimpleNamespace(probing=unit) for name, unit in self.units.items()}
        lists = {
            name: MeasuringAxis(
                source=source, simulated=(CYCLES if name in simulated else 0, 2, 0, 0, 0)
            )
            for name, source in sources.items()
        }
        self.bench = Bench(SimpleNamespace(task=self.task, axis=at_plc), **lists)
        self.measurement, self.links = self.bench.measurement, self.bench.links
        for link in self.links.values():
            link.__dict__.update(
                is_clear=True, is_armed=True, is_prepared=True, has_latched=False, has_actual=True,
                latched_mm=None, latched_speed_mm=0.0, doubt_mm=None, actual_mm=0.0,
                is_confirmed=lambda: True, settings=SimpleNamespace(increments_per_mm=1e4,
                acceleration_mm_s2=1e3, probe_input=1, edge="POS"),
            )  # fmt: skip
        self.levels = dict.fromkeys(AXES, False)
        self.probes = {name: SimulatedProbe(name, CYCLES, 2, Way({}, {}), ()) for name in simulated}

    def run(self, *axes: str) -> Any:
        return self.bench.arm(1, *axes, simulated=self.probes)

    def cycle(self, run: Any, *, is_standing: bool = False) -> None:
        """The PLC acknowledges at once; every position is that of this cycle."""
        clock = self.bench.clock
        clock.now_ns += MS
        self.task.written_ns = clock.now_ns
        for place, (name, unit) in enumerate(self.units.items(), 1):
            self.task.sync_ns[name] = clock.now_ns - MS // 2
            self.links[name].actual_mm = 10.0 * place * (clock.now_ns // MS)
            stamp_ns = clock.now_ns - MS // 2
            unit.take(AxisWrites(self.levels[name], stamp_ns, done_order=unit.number), clock.now_ns)
        self.measurement.step()
        if run.state is RunState.MOVING:
            for probe in self.probes.values():
                probe.look(dict.fromkeys(AXES, MADE_MM), {})
        run.evaluate(clock.now_ns, is_standing, clock.now_ns if is_standing else None)

    def until(self, run: Any, state: RunState, *, is_standing: bool = False) -> None:
        for _ in range(20):
            if run.state is state:
                return
            self.cycle(run, is_standing=is_standing)
        raise AssertionError(run.state)


@pytest.mark.parametrize("source", [*OF_DRIVE, *AT_PLC])
@pytest.mark.parametrize("is_simulated", [False, True])
def test_a_run_arms_the_latch_of_its_source_and_a_simulated_probe_in_place_of_any(
    source: str, is_simulated: bool
) -> None:
    """Of a simulated one neither drive nor PLC has to do anything, and no signal is waited for."""
    rig = Rig({"Z": source}, ("Z",) if is_simulated else ())
    run = rig.run("Z")
    rig.until(run, RunState.MOVING)
    armed_drive = source in OF_DRIVE or source == EXTERNAL_WITH_DRIVE
    assert ("arm" in rig.links["Z"].orders) is (armed_drive and not is_simulated)
    enabled = rig.units["Z"].order.task is LatchTask.ENABLE
    assert enabled is (source in SWITCHED and not is_simulated)
    assert rig.measurement.may_choose() is (source in OF_DRIVE or is_simulated)
    if is_simulated:
        for _ in range(2):
            rig.cycle(run)
        rig.until(run, RunState.DONE, is_standing=True)
        assert run.record.latched_mm == {"Z": MADE_MM}
        assert rig.probes["Z"].is_clear
    assert run.record.sources == {"Z": source}


@pytest.mark.parametrize("source", AT_PLC)
def test_a_simulated_axis_needs_no_task_of_the_plc(source: str) -> None:
    for simulated in (0, CYCLES):
        axis = MeasuringAxis(source=source, simulated=(simulated, 2, 0, 0, 0))
        bench = Bench(Z=axis)
        if simulated:
            bench.measurement.check("Z", 1)
            continue
        with pytest.raises(Alarm) as caught:
            bench.measurement.check("Z", 1)
        assert (caught.value.id, caught.value.values["source"]) == (900400, source)


@pytest.mark.parametrize("order", [("X", "Y", "Z"), ("Z", "Y", "X")])
def test_every_axis_has_the_value_of_its_own_latch(order: tuple[str, ...]) -> None:
    """X in its drive at 1.5 mm, Y by the signal of the PLC in a cycle at 20 mm times its number,
    Z simulated at 77 mm.
    """
    rig = Rig({"X": "DRIVE", "Y": PLC, "Z": PLC}, ("Z",))
    run = rig.run(*order)
    rig.until(run, RunState.MOVING)
    rig.levels["Y"] = True
    rig.cycle(run)
    edge_ms = rig.bench.clock.now_ns // MS
    rig.links["X"].has_latched, rig.links["X"].latched_mm = True, 1.5
    for _ in range(4):
        rig.cycle(run)
    rig.until(run, RunState.DONE, is_standing=True)
    assert run.record.latched_mm == {"X": 1.5, "Y": 20.0 * edge_ms, "Z": MADE_MM}
    assert run.record.axes == order
    rig.measurement.keep(run.record)
    assert rig.measurement.measured_acs_mm("Z") == MADE_MM


@pytest.mark.parametrize("source", AT_PLC)
def test_what_a_source_at_the_plc_shows_of_its_probe(source: str) -> None:
    """Nothing before its first run, then its signal, or the drive while the probe is on."""
    rig = Rig({"Z": source})
    assert rig.measurement.is_actuated("Z") is None
    rig.links["Z"].is_actuated = False
    run = rig.run("Z")
    rig.until(run, RunState.MOVING)
    assert rig.measurement.is_actuated("Z") is False
    rig.levels["Z"] = rig.links["Z"].is_actuated = True
    rig.cycle(run)
    assert rig.measurement.is_actuated("Z") is True
    run.abort()
    is_off = source == EXTERNAL_WITH_DRIVE
    assert rig.measurement.is_actuated("Z") is (None if is_off else True)
    assert rig.measurement.may_choose()
