"""Programs and rigs written for one test, run on the real plants, and what they left behind.

The helpers hold no formula of the bench: closed forms stand in the tests.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.machine.plc_programs import HEAD

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.machine.facts import facts_of
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.record.facts import Facts
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.channel import Channel
from axisrig.kernel.nc.text.parser import read_program

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
SYNC_BITS = 48
"""SYNC on the wire: 44 bits of a frame without data and 4 stuff bits of identifier 0x080."""


@dataclass(frozen=True)
class Outcome:
    """What a program left: printed lines, alarm IDs, and the machine with its truth."""

    lines: list[str]
    alarms: list[int]
    machine: Machine
    facts: Facts

    @cached_property
    def observed(self) -> Observed:
        """What the run has left, as judges read it."""
        return Observed(self.facts, self.machine.recorder.series())

    def printed(self, name: str) -> list[float]:
        """Every number that was printed as `name=number`, in order."""
        pairs = [line.split("=") for line in self.lines]
        return [float(value) for key, value in pairs if key == name]

    def column(self, name: str) -> NDArray[np.float64]:
        """A column of the trace."""
        values: NDArray[np.float64] = self.machine.recorder.table().column(name).to_numpy()
        return values

    def edge_ns(self, run: int = 0) -> int:
        """First edge at the terminal inside the given measurement run."""
        record = self.machine.channel.records[run]
        (probe,) = self.machine.plant.probes.values()
        assert record.end_ns is not None
        return next(t for t, _ in probe.signal.edges if record.begin_ns <= t <= record.end_ns)

    def stand_mm(self, axis: str, run: int = 0) -> float:
        """True position of the load when the given measurement run ended."""
        times, truth = self.column("time_ns"), self.column(f"{axis}.truth_mm")
        end_ns = self.machine.channel.records[run].end_ns
        assert end_ns is not None
        return float(truth[np.searchsorted(times, end_ns, side="right") - 1])

    def waited_s(self, latch_ns: float, bitrate: int = 1_000_000) -> float:
        """U: from an instant to the next delivery of a SYNC."""
        period_ns = self.machine.timing.period_ns
        return float((SYNC_BITS * 10**9 / bitrate - latch_ns) % period_ns) / 1e9


RunNc = Callable[..., Outcome]
Watch = Callable[[Channel], None]


@pytest.fixture
def run_nc(tmp_path: Path) -> RunNc:
    """Return `run(program, rig, *assignments, base=...)`; rig is TOML put above a shipped rig."""
    count = 0

    def run(
        program: str,
        rig: str,
        *assignments: str,
        base: str = "probe-xyz.toml",
        watch: Watch | None = None,
    ) -> Outcome:
        nonlocal count
        count += 1
        rig_file, nc_file = tmp_path / f"rig{count}.toml", tmp_path / f"program{count}.nc"
        rig_file.write_text(f'base = "{(RIGS / base).as_posix()}"\n{rig}\n', encoding="utf-8")
        nc_file.write_text(f"%unseen\n{program}\nN9999 M30\n", encoding="utf-8")
        # Geometry to a nanometre needs axes that stand: exact-stop windows of 0.1 um
        fine = [f"set:{a}.getriebe[0].window=1" for a in ("XYZ" if "xyz" in base else "")]
        return run_files(nc_file, rig_file, [*fine, *assignments], watch)

    return run


@pytest.fixture
def run_plc(tmp_path: Path, run_nc: RunNc) -> Callable[..., Outcome]:
    """Return `run(NC program, body of the class, *assignments, keys=TOML)`."""

    def run(nc: str, body: str, *assignments: str, keys: str = "period_us = 2000") -> Outcome:
        (tmp_path / "plc.py").write_text(HEAD + body, encoding="utf-8")
        rig = f'[plc]\nprogram = "plc.py"\n{keys}\n'
        return run_nc(nc, rig, *assignments, base="probe-z.toml")

    return run


@pytest.fixture
def run_own() -> Callable[..., Outcome]:
    """Return `run(program file, rig file, assignments)`."""
    return run_files


def run_files(
    program: Path, rig: Path, assignments: Sequence[str] = (), watch: Watch | None = None
) -> Outcome:
    """Run a program file on a rig file in this process; watch: called in every cycle."""
    table, files = read_rig(rig)
    changes = [(parse_assignment(text), as_written) for text in assignments]
    settings = read_settings(table, files, changes)
    machine = Machine(settings, read_program(program, tuple(table.axis)))
    if watch is not None:
        machine.channel.observers.append(watch)
    try:
        facts = facts_of(machine, machine.run())
    finally:
        machine.close()
    return Outcome(
        [message.text for message in machine.messages],
        [alarm.id for alarm in machine.channel.alarms],
        machine,
        facts,
    )
