"""A case before it runs: its rig with the inputs of its row, and whether all of it can be run."""

from collections.abc import Iterable, Sequence

from axisrig.bench.machine.machine import Machine
from axisrig.bench.machine.plants import check_plant
from axisrig.bench.plan.assignment import Assignment
from axisrig.bench.plan.plan import Case
from axisrig.bench.rig.programs import programs_of
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.real_axes import is_paced
from axisrig.bench.rig.settings import Settings, read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.syntax import Command, Program
from axisrig.kernel.nc.text.parser import read_program


def settings_of(case: Case) -> Settings:
    """Read the rig of a case and apply its row. Raises UserError with the place of a mistake."""

    def located(error: UserError, assignment: Assignment) -> UserError:
        return case.error(
            error.message,
            assignment.column,
            value=error.value if error.value is not None else assignment.value,
            allowed=error.allowed,
            hint=error.hint,
        )

    rig, files = read_rig(case.rig)
    return read_settings(rig, files, [(item, located) for item in case.assignments()])


def prepare(case: Case) -> None:
    """Build the machine of a case and take it down again.

    Raises UserError for everything that can be known before a run, so that a plan with a mistake
    in its last row leaves nothing half-written.
    """
    settings = settings_of(case)
    program = read_program(case.program, tuple(settings.rig.axis))
    programs = programs_of(settings, program).values()
    _check_metrics(case, tuple(settings.rig.axis), programs)
    if is_paced(settings):
        check_plant(settings)  # without the bus: nothing is sent before the run
    else:
        Machine(settings, program).close()


def _check_metrics(case: Case, axes: Sequence[str], programs: Iterable[Program]) -> None:
    """Refuse checks of axes that the rig, and of blocks that the programs, do not have."""
    blocks = [
        f"N{part.block.number}"
        for program in programs
        for part in program.blocks
        if isinstance(part.statement, Command) and part.statement.name.startswith("MSG")
    ]
    for check in case.checks:
        column = f"check:{check.metric}"
        if check.axis is not None and check.axis not in axes:
            raise case.error("the rig has no such axis", column, value=check.axis, allowed=axes)
        if check.block is not None and check.block[0] not in blocks:
            raise case.error(
                "the program has no #MSG in such a block",
                column,
                value=check.block[0],
                allowed=blocks or "none",
            )
