"""A case before it runs: its rig with the inputs of its row, and whether all of it can be run.

A case that was found good is kept by the process: it is read and checked again only when a file
that it was made from has another content.
"""

import hashlib
from collections import OrderedDict
from collections.abc import Hashable, Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from axisrig.bench.machine.machine import Machine
from axisrig.bench.machine.plants import check_plant
from axisrig.bench.plan.assignment import Assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.probes import probe_of
from axisrig.bench.rig.programs import programs_of, started_files
from axisrig.bench.rig.reading.file import MAP_KEYS, read_rig
from axisrig.bench.rig.reading.sources import rig_files
from axisrig.bench.rig.real_axes import is_paced
from axisrig.bench.rig.settings import Settings, read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.syntax import Command, Program, SubprogramCall
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


class Prepared(NamedTuple):
    """A case that can be run: its rig with the inputs of its row, and its program.

    Both are read only: runs of the case share them.
    """

    settings: Settings
    program: Program


class _Kept(NamedTuple):
    """What is known of a case, as long as files have this content."""

    prepared: Prepared
    files: Sequence[Path]
    content: Sequence[Hashable]


KEPT_MAX = 256
"""Cases that are kept, some 0.1 MB each."""
_kept: OrderedDict[Hashable, _Kept] = OrderedDict()


def recall(case: Case) -> Prepared | None:
    """Return what `prepare` has found out about a case; None when it has to be done again."""
    key = _key(case)
    kept = _kept.get(key)
    if kept is None:
        return None
    if _content(kept.files) != kept.content:
        del _kept[key]
        return None
    _kept.move_to_end(key)
    return kept.prepared


def forget() -> None:
    """Drop every case that is kept."""
    _kept.clear()


def _key(case: Case) -> Hashable:
    place = (case.file, case.line, case.case, tuple(case.places), case.overridden)
    return (*place, case.rig, case.program, tuple(case.inputs.items()), case.checks, case.sampled)


def _keep(case: Case, prepared: Prepared, files: Sequence[Path], content: object) -> None:
    """Keep a case, unless it may depend on other files, or one was written meanwhile."""
    if _has_other_files(case, prepared) or _content(files) != content:
        return
    prepared.settings.is_checked = True
    _kept[_key(case)] = _Kept(prepared, files, _content(files))
    if len(_kept) > KEPT_MAX:
        _kept.popitem(last=False)


def _has_other_files(case: Case, prepared: Prepared) -> bool:
    """Whether programs are called or started, or a cell names a file of a drive."""
    program = prepared.program
    parts = [part for blocks in (program.blocks, *program.subprograms.values()) for part in blocks]
    calls = [part.statement for part in parts if isinstance(part.statement, SubprogramCall)]
    return (
        any(call.scope != "local" for call in calls)
        or bool(started_files(prepared.settings))
        or any(item.kind == "drive" and item.name in MAP_KEYS for item in case.assignments())
    )


def _content(files: Iterable[Path]) -> list[Hashable]:
    """Return a hash of the content of each file; of an FMU, which may be large, its state."""
    found: list[Hashable] = []
    for file in files:
        try:
            if file.suffix == ".fmu":
                state = file.stat()
                found.append((state.st_mtime_ns, state.st_size, state.st_ino))
            else:
                found.append(hashlib.sha256(file.read_bytes()).digest())
        except OSError:
            found.append(None)
    return found


def prepare(case: Case) -> Prepared:
    """Build the machine of a case and take it down again, once per content of its files.

    Of one that searches, those of both ends; what the first one is made of is returned.

    Raises UserError for everything that can be known before a run, so that a plan with a mistake
    in its last row leaves nothing half-written.
    """
    if case.search is not None:
        ends = (case.search.first, case.search.last)
        made = [
            prepare(probe_of(case, number, case.search.value(end)))
            for number, end in enumerate(ends, start=1)
        ]
        return made[0]
    if (known := recall(case)) is not None:
        return known
    files = [case.program, *rig_files(case.rig)]
    content = _content(files)
    settings = settings_of(case)
    program = read_program(case.program, tuple(settings.rig.axis))
    programs = programs_of(settings, program).values()
    _check_metrics(case, tuple(settings.rig.axis), programs)
    prepared = Prepared(settings, program)
    if is_paced(settings):
        check_plant(settings)  # without the bus: nothing is sent before the run
    else:
        Machine(settings, program).close()
        _keep(case, prepared, files, content)
    return prepared


def _check_metrics(case: Case, axes: Sequence[str], programs: Iterable[Program]) -> None:
    """Refuse checks of axes that the rig, and of blocks that the programs, do not have."""
    blocks = [
        f"N{part.block.number}"
        for program in programs
        for part in program.blocks
        if isinstance(part.statement, Command) and part.statement.name.startswith("MSG")
    ]
    for check in (*case.checks, *case.sampled):
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
