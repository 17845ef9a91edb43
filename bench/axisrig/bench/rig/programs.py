"""The programs of a run: its own, and those that the PLC side starts (`plc:program_start`)."""

from collections.abc import Mapping
from pathlib import Path

from axisrig.bench.rig.plc.channel_words import ProgramStart
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.syntax import Program
from axisrig.kernel.nc.text.parser import read_program


def started_files(settings: Settings) -> tuple[str, ...]:
    """Return the files that the PLC side starts, as its cells name them."""
    actions = [rule.action for rule in settings.plc]
    files = [a.file for a in actions if isinstance(a, ProgramStart) and a.file is not None]
    return tuple(dict.fromkeys(files))


def programs_of(settings: Settings, program: Program) -> Mapping[str | None, Program]:
    """Read the programs of a run, by what `file=` names; None is that of the run.

    Files are beside the program of the run. Raises UserError for one that cannot be read.
    """
    folder = Path(program.file or ".").parent
    programs: dict[str | None, Program] = {None: program}
    for file in started_files(settings):
        try:
            programs[file] = read_program(folder / file, program.axes)
        except UserError as error:
            if error.line is not None:
                raise
            hint = "a file beside the program of the run"
            raise UserError(f"plc:program_start: {error.message}", value=file, hint=hint) from error
    return programs
