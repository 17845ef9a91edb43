"""Machines of the scenarios: the rows of `machines.csv`.

Rigs and programs are beside the table, or of the shipped plans (`testplans/...`, from the folder in
which the command runs, as with `axisrig demo`).
"""

import csv
import random
from dataclasses import dataclass
from functools import cache
from importlib import resources
from pathlib import Path

from axisrig.bench.machine.faults.points import points
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.canopen.keys import DriveTable
from axisrig.bench.rig.reading.file import RigFile, read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.bench.tools.scenarios.drawing import draw_inputs
from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.nc.syntax import Program
from axisrig.kernel.nc.text.parser import read_program

FOLDER = Path(__file__).parent
SHIPPED = "testplans"
ONE_AXIS = "one-axis"
"""The first row: what runs without a choice."""
ALL = "all"
EVERY = "every"
"""In a cell: all of its kind."""


@dataclass(frozen=True)
class MachineRow:
    """A machine of the scenarios.

    inputs: as `drawing` reads them. profiles: of its drives, one is drawn; none: as the rig has it.
    weights: column of `kinds.csv`. source: of its signals, P-AXIS-00516, empty without a run.
    prints: blocks that print the value of the first run, of the second .. still: axes that the
    program does not move.
    """

    name: str
    title: str
    rig: str
    program: str
    inputs: str
    profiles: tuple[str, ...]
    weights: str
    source: str
    prints: tuple[int, ...]
    still: tuple[str, ...]

    def values_of(self, right: int) -> int:
        """Return how many values were measured of what is printed and published."""
        return right // 2 if self.prints else right


@cache
def machines() -> dict[str, MachineRow]:
    """Read the table: name -> machine, in its order."""
    text = resources.files(__package__).joinpath("machines.csv").read_text(encoding="utf-8")
    return {
        row["machine"]: MachineRow(
            name=row["machine"],
            title=row["title"],
            rig=row["rig"],
            program=row["program"],
            inputs=row["inputs"],
            profiles=tuple(row["profiles"].split()),
            weights=row["weights"],
            source=row["source"],
            prints=tuple(int(block[1:]) for block in row["prints"].split()),
            still=tuple(row["still"].split()),
        )
        for row in csv.DictReader(text.splitlines())
    }


def machines_named(name: str) -> list[MachineRow]:
    """Return the machine of a name, or all of them. Raises UserError for one that is not there."""
    known = machines()
    if name == ALL:
        return list(known.values())
    if name not in known:
        allowed = nearest(name, known) or [*known, ALL]
        raise UserError("no such machine of the scenarios", value=name, allowed=allowed)
    return [known[name]]


def path_of(text: str) -> Path:
    """Return the file of a rig or program. Raises UserError where it is not there."""
    path = Path(text) if text.startswith(f"{SHIPPED}/") else FOLDER / text
    if not path.is_file():
        raise UserError(
            "a file of a machine of the scenarios is not there",
            file=path,
            hint=f"run where the folder {SHIPPED} is, in a checkout",
        )
    return path


# The truth of the oracle is the position one input delay after the edge, whatever the profile
_EXACT = {"latch": "interpolated", "input_jitter_us": 0.0, "input_filter_us": 0.0,
          "min_pulse_us": 0.0, "dead_time_us": 0.0, "delay_compensation_us": 0.0,
          "latch_encoder": "motor"}  # fmt: skip


@cache
def rig_of(machine: str, profile: str = "") -> tuple[RigFile, list[Path]]:
    """Return the rig of a machine with its files; profile: of all its drives, where one is given.

    What a profile does to the latched position is taken out. Raises UserError as `read_rig`.
    """
    rig, files = read_rig(path_of(machines()[machine].rig))
    if not profile:
        return rig, files
    keys = ("encoder_increments", "lead_mm", "input_delay_us", "sync_loss_periods", "heartbeat_ms")
    drives = {
        name: DriveTable.model_validate(
            {"profile": profile, **_EXACT, **{key: getattr(given, key) for key in keys}}
        )
        for name, given in rig.drive.items()
    }
    return rig.model_copy(update={"drive": drives}), files


@cache
def program_of(machine: str) -> Program:
    """Return the program of a machine. Raises UserError as `read_program`."""
    rig, _ = rig_of(machine)
    return read_program(path_of(machines()[machine].program), tuple(rig.axis))


@cache
def places_of(machine: str, kind: str) -> tuple[str, ...]:
    """Return every fault point of a machine that a kind of fault can be done to."""
    return tuple(target for target, kinds in _points_of(machine).items() if kind in kinds)


@cache
def _points_of(machine: str) -> dict[str, tuple[str, ...]]:
    """Return the fault points of a machine: target -> kinds; inputs decide nothing about them."""
    rig, files = rig_of(machine)
    inputs = draw_inputs(machines()[machine].inputs, random.Random(0))
    settings = read_settings(rig, files, [(parse_assignment(text), as_written) for text in inputs])
    built = Machine(settings, program_of(machine))
    try:
        return {target: point.kinds for target, point in points(built).items()}
    finally:
        built.close()
