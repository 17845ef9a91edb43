"""One NC program on one rig: what `axisrig nc` does."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from axisrig.bench.campaign.hardware_runs import Outside, allow, refuse_processes
from axisrig.bench.campaign.used_variables import is_variable, used_variables
from axisrig.bench.judge.program.findings import program_notes
from axisrig.bench.machine.facts import facts_of
from axisrig.bench.machine.machine import Machine, SimulatedTimeoutError
from axisrig.bench.machine.pacing import Hardware
from axisrig.bench.machine.plants import check_plant
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.real_axes import is_paced
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program


@dataclass(frozen=True)
class Ended:
    """What is to be said of a run, an alarm or a note, and whether it ended the program."""

    text: str
    ends_program: bool


def run_outside(
    outside: Outside,
    program: Path,
    rig: Path,
    assignments: Sequence[str],
    bus_logs: Sequence[Path],
    put_out: Callable[[str], None],
    *,
    is_apart: bool,
) -> list[Ended] | None:
    """Run a program on axes outside, as `run_program`; None when the rig has no real bus."""
    table, files = read_rig(rig)
    changes = [*assignments]
    changes += [f"{item.column}={item.value}" for item in outside.changes(table.segment, rig)]
    assigned = [(parse_assignment(text), as_written) for text in changes]
    settings = read_settings(table, files, assigned)
    if not is_paced(settings):
        return None
    refuse_processes(1, is_apart)
    read_program(program, tuple(table.axis))
    check_plant(settings)
    allow([settings], outside)
    with outside.open_hardware() as hardware:
        return run_program(program, rig, changes, bus_logs, put_out, hardware)


def run_program(
    program: Path,
    rig: Path,
    assignments: Sequence[str],
    bus_logs: Sequence[Path],
    put_out: Callable[[str], None],
    hardware: Hardware | None = None,
) -> list[Ended]:
    """Run a program to its end; return what is to be noted of it, and its alarms in order.

    assignments: texts of `--set`. put_out: takes each message when it is due. hardware: for rigs
    with a real bus; how well real time was kept is among the notes then.
    Raises UserError for what is rejected before or while the program runs.
    """
    changes = [(parse_assignment(text), as_written) for text in assignments]
    table, files = read_rig(rig)
    settings = read_settings(table, files, changes)
    parsed = read_program(program, tuple(table.axis))
    used = used_variables(settings, program, parsed)
    for item, _ in changes:
        if is_variable(item) and not used.has(item.column):
            error = used.error(item, program)
            raise UserError(f"--set {error.message}", value=error.value, hint=error.hint)
    machine = Machine(settings, parsed, bus_logs=bus_logs, put_out=put_out, hardware=hardware)
    try:
        facts = facts_of(machine, machine.run())
    except (PlantError, SimulatedTimeoutError) as error:
        raise UserError(str(error), file=program) from error
    finally:
        machine.close()
    return [Ended(text, ends_program) for text, ends_program in program_notes(facts)]
