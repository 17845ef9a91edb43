"""Instants of a measurement run of a shipped plan: each as the participant itself has it.

The machine runs with onlookers at the plant, the bus, the PLC task and the NC cycle; nothing is
computed here from periods or delays.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from axisrig.bench.campaign.preparing import settings_of  # noqa: E402
from axisrig.bench.judge.fixed_stop.run import stop_runs  # noqa: E402
from axisrig.bench.judge.observed.observed import Observed  # noqa: E402
from axisrig.bench.machine.canopen.family import CanBuses  # noqa: E402
from axisrig.bench.machine.facts import facts_of  # noqa: E402
from axisrig.bench.machine.machine import Machine  # noqa: E402
from axisrig.bench.plan.plan import read_plan  # noqa: E402
from axisrig.bench.record.facts import Facts  # noqa: E402
from axisrig.bench.record.measuring import MeasurementRun  # noqa: E402
from axisrig.bench.record.series import Series  # noqa: E402
from axisrig.kernel.nc.text.parser import read_program  # noqa: E402

PLANS = ROOT / "testplans"
AXIS = "Z"
INPUT_1 = 1 << 16  # of 60FD
BRAKES_MM = 1e-9
"""A set step that is shorter than the one before by more than rounding."""


@dataclass
class PlcCycle:
    """One cycle of the PLC task: what its program has read, and written."""

    time_ns: int
    level: bool | None
    stamp_ns: int
    signal: bool
    task: int
    is_done: bool
    digital_inputs: int


@dataclass
class NcCycle:
    """One NC cycle: what the CNC had taken from the PLC, and the task that it asks for."""

    time_ns: int
    written_ns: int | None
    signal: bool
    task: int
    number: int
    done_number: int
    digital_inputs: int


class Handshake(NamedTuple):
    """NC cycle that asks, cycles of the PLC that read and acknowledge, NC cycle that sees it."""

    asked_ns: int
    read_ns: int
    done_ns: int
    seen_ns: int


@dataclass
class Recorded:
    """A run with its instants, ns of the bus time.

    frames: end and identifier of every frame of the bus of the axis. times_ns, truth_mm, set_mm: of
    the SYNCs, shape (n,), with the true positions at them and the set positions sent after them.
    stops: runs to a fixed stop, with the contact in the plant's truth.
    """

    facts: Facts
    run: MeasurementRun
    frames: list[tuple[int, int]] = field(default_factory=list)
    plc: list[PlcCycle] = field(default_factory=list)
    nc: list[NcCycle] = field(default_factory=list)
    series: dict[str, Any] = field(default_factory=dict)
    stops: list[Any] = field(default_factory=list)

    @property
    def times_ns(self) -> Any:
        """SYNCs of the run."""
        return self.series["time_ns"]

    @property
    def contact_ns(self) -> int:
        """Contact of the probe in the run, by its plant."""
        return min(
            contact.time_ns
            for probe in self.facts.probes.values()
            for contact in probe.contacts
            if contact.time_ns >= self.run.begin_ns
        )

    @property
    def edge_ns(self) -> int:
        """First edge of the probe in the run."""
        return min(
            edge.time_ns
            for probe in self.facts.probes.values()
            for edge in probe.edges
            if edge.time_ns >= self.contact_ns
        )

    @property
    def latch_ns(self) -> int:
        """Instant whose position the drive has stored."""
        return next(
            latch.time_ns
            for latch in self.facts.axes[AXIS].latches
            if latch.time_ns >= self.contact_ns
        )

    @property
    def signal_ns(self) -> int:
        """NC cycle that has seen the signal."""
        assert self.run.signal_ns is not None
        return self.run.signal_ns

    @property
    def plc_ns(self) -> int:
        """Cycle of the PLC whose program has set the probing signal."""
        return next(c.time_ns for c in self.plc if c.time_ns > self.contact_ns and c.signal)

    @property
    def taken_ns(self) -> int:
        """NC cycle that has taken it."""
        return next(c.time_ns for c in self.nc if c.time_ns > self.contact_ns and c.signal)

    @property
    def image_ns(self) -> int:
        """Cycle of the PLC in whose image the level of the probe has risen."""
        return next(c.time_ns for c in self.plc if c.time_ns >= self.contact_ns and c.level)

    @property
    def stamp_ns(self) -> int:
        """Stamp of the edge, as the program of the PLC has read it."""
        return next(c.stamp_ns for c in self.plc if c.time_ns == self.image_ns)

    def inputs_ns(self, who: Sequence[PlcCycle] | Sequence[NcCycle]) -> int:
        """First cycle in which a participant sees input 1 of the drive (60FD)."""
        return next(
            c.time_ns for c in who if c.time_ns > self.contact_ns and c.digital_inputs & INPUT_1
        )

    def handshake(self, number: int) -> "Handshake":
        """The order of this number between CNC and PLC; the first one has 1."""
        asked = next(c for c in self.nc if c.number == number)
        acknowledged = next(c.time_ns for c in self.nc if c.done_number == number)
        of_plc = [c for c in self.plc if asked.time_ns < c.time_ns < acknowledged]
        read = next(c.time_ns for c in of_plc if c.task == asked.task)
        done = next(c.time_ns for c in of_plc if c.task == asked.task and c.is_done)
        return Handshake(asked.time_ns, read, done, acknowledged)

    def sync_before(self, time_ns: int) -> int:
        """Last SYNC before an instant, as the drive has it."""
        return int(self.times_ns[np.searchsorted(self.times_ns, time_ns) - 1])

    def sync_after(self, time_ns: int) -> int:
        """First SYNC at or after an instant, as the drive has it."""
        return int(self.times_ns[np.searchsorted(self.times_ns, time_ns)])

    def frame_after(self, time_ns: int, can_id: int) -> int:
        """End of the first frame of an identifier that ends after an instant."""
        return next(end for end, found in self.frames if end > time_ns and found == can_id)

    @property
    def brakes_ns(self) -> int:
        """NC cycle that has sent the first set position whose step is shorter.

        A set position belongs to the SYNC before it: the cycle is the first one after this.
        """
        ways = np.abs(np.diff(self.series[f"{AXIS}.set_mm"]))
        first = int(np.searchsorted(self.times_ns, self.contact_ns))
        row = next(n for n in range(first - 2, len(ways)) if ways[n] < ways[n - 1] - BRAKES_MM)
        return next(c.time_ns for c in self.nc if c.time_ns > self.times_ns[row + 1])

    def truth_mm(self, time_ns: Any) -> Any:
        """True position at instants between SYNCs, cubic through both ends."""
        from scipy.interpolate import CubicHermiteSpline  # noqa: PLC0415

        path = CubicHermiteSpline(
            self.times_ns * 1e-9,
            self.series[f"{AXIS}.truth_mm"],
            self.series[f"{AXIS}.velocity_mm_s"],
        )
        return path(np.asarray(time_ns) * 1e-9)


def _watch_plc(found: Recorded, machine: Machine) -> None:
    def watch(inputs: Any, hli: Any) -> None:
        control, state = hli.ax[AXIS].lr_mc_control, hli.ax[AXIS].lr_state
        image = inputs.channel.get(1)
        found.plc.append(
            PlcCycle(
                inputs.time_ns,
                None if image is None else image.input,
                0 if image is None else image.latch_pos_ns,
                control.probing_signal.enable_w and control.probing_signal.command_w,
                control.ext_latch.task_r,
                control.ext_latch.done_w and not control.ext_latch.please_rw,
                state.digital_inputs_r,
            )
        )

    if machine.plc_task is not None:
        machine.plc_task.observers.append(watch)


def _watch_nc(found: Recorded, machine: Machine) -> None:
    def watch(channel: Any) -> None:
        unit, task = channel.plc.axis[AXIS].probing, channel.plc.task
        found.nc.append(
            NcCycle(
                machine.scheduler.now_ns,
                None if task is None else task.written_ns,
                bool(unit.writes.signal),
                int(unit.order.task),
                unit.number,
                unit.writes.done_order,
                next(link.digital_inputs or 0 for link in channel.links if link.name == AXIS),
            )
        )

    machine.channel.observers.append(watch)


def record(plan: str, case: str, run: int = 0) -> Recorded:
    """Run a case of a shipped plan; run: which of its measurement runs is looked at."""
    (row,) = (each for each in read_plan(PLANS / f"{plan}.csv").cases if each.case == case)
    settings = settings_of(row)
    machine = Machine(settings, read_program(row.program, tuple(settings.rig.axis)))
    found = Recorded(None, None)  # type: ignore[arg-type]
    try:
        _watch_plc(found, machine)
        _watch_nc(found, machine)
        part = machine.part_of[AXIS]
        assert isinstance(part, CanBuses)
        part.segments[settings.rig.axis[AXIS].segment].observe(
            lambda end_ns, _name, frame, _error: found.frames.append((end_ns, frame.arbitration_id))
        )
        machine.run()
        found.facts = facts_of(machine)
        table = machine.recorder.table()
        found.series = {name: np.asarray(table[name]) for name in table.column_names}
        found.stops = stop_runs(Observed(found.facts, Series(table)))
    finally:
        machine.close()
    found.run = found.facts.runs[run]
    return found
