"""One NC program on one rig: what `axisrig nc` does."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.plan.assignment import parse_assignment
from bench.rig.check import overloads
from bench.rig.file import read_rig
from bench.rig.machine import Machine, SimulatedTimeoutError
from bench.rig.plants import plant_log
from bench.rig.settings import as_written, read_settings
from kernel.cosim.fmu import PlantError
from kernel.errors import UserError
from kernel.nc.parser import read_program


@dataclass(frozen=True)
class Ended:
    """What is to be said of a run, an alarm or a note, and whether it ended the program."""

    text: str
    ends_program: bool


def run_program(
    program: Path,
    rig: Path,
    assignments: Sequence[str],
    bus_log: Path | None,
    put_out: Callable[[str], None],
) -> list[Ended]:
    """Run a program to its end; return what its plants lack, and its alarms in order.

    assignments: texts of `--set`. put_out: takes each message when it is due.
    Raises UserError for what is rejected before or while the program runs.
    """
    changes = [(parse_assignment(text), as_written) for text in assignments]
    table, files = read_rig(rig)
    settings = read_settings(table, files, changes)
    parsed = read_program(program, tuple(table.axis))
    machine = Machine(settings, parsed, bus_log=bus_log, put_out=put_out)
    try:
        machine.run()
    except (PlantError, SimulatedTimeoutError) as error:
        raise UserError(str(error), file=program) from error
    finally:
        machine.close()
    notes = [
        Ended(f"segment {name} is overloaded: {text}", False)
        for name, text in overloads(settings).items()
    ]
    notes += [Ended(text, False) for text in plant_log(machine.plant)]
    return notes + [Ended(str(alarm), alarm.ends_program) for alarm in machine.channel.alarms]
