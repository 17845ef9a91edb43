"""A case before it runs: its rig with the inputs of its row, and whether all of it can be run.

A case that was found good is kept by the process: it is read and checked again only when a file
that it was made from has another content.
"""

import hashlib
from collections import OrderedDict
from collections.abc import Hashable, Iterable, Iterator, Sequence
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from axisrig.bench.campaign.used_variables import is_variable, used_variables
from axisrig.bench.machine.machine import Machine
from axisrig.bench.machine.plants import check_plant
from axisrig.bench.plan.assignment import Assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.composition import Mistakes
from axisrig.bench.plan.probes import probe_of
from axisrig.bench.rig.programs import programs_of, started_files
from axisrig.bench.rig.reading.file import RigFile, read_rig
from axisrig.bench.rig.reading.sources import rig_files
from axisrig.bench.rig.real_axes import is_paced
from axisrig.bench.rig.settings import Settings, read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.decoder.base.subprograms import link, reachable
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

    rig, files = _rig(case.rig)
    return read_settings(rig, files, [(item, located) for item in case.assignments()])


_rigs: dict[Path, tuple[RigFile, list[Path], Sequence[Hashable]]] = {}


def _rig(path: Path) -> tuple[RigFile, list[Path]]:
    """Read a rig, once per content of its files: many rows of a plan have the same."""
    place = path.absolute()  # a path may be relative, and the working folder another one now
    known = _rigs.get(place)
    if known is None or _content(known[1]) != known[2]:
        rig, files = read_rig(path)
        known = _rigs[place] = rig, files, _content(files)
    return known[0], list(known[1])


def _program(path: Path, axes: tuple[str, ...]) -> Program:
    """Read a program, once per content and axes."""
    try:
        content = path.read_bytes()
    except OSError:
        return read_program(path, axes)
    return _parsed(path, path.absolute(), axes, content)


@lru_cache(maxsize=64)
def _parsed(path: Path, _place: Path, axes: tuple[str, ...], _content: bytes) -> Program:
    return read_program(path, axes)


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
    _rigs.clear()
    _parsed.cache_clear()


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
        or any(item.names_file for item in case.assignments())
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
        prepared, _ = [prepare(probe) for probe in _ends(case)]
        return prepared
    if (known := recall(case)) is not None:
        return known
    files = [case.program, *rig_files(case.rig)]
    content = _content(files)
    prepared = read_case(case)
    if is_paced(prepared.settings):
        check_plant(prepared.settings)  # without the bus: nothing is sent before the run
    else:
        Machine(*prepared).close()
        _keep(case, prepared, files, content)
    return prepared


def read_case(case: Case) -> Prepared:
    """Read what a case names, apply its row, and check what its checks ask for; build nothing.

    Of one that searches, with the values of both ends. Raises UserError for what is wrong with
    rig, lists, programs or cells.
    """
    if case.search is not None:
        read, _ = [read_case(probe) for probe in _ends(case)]
        return read
    settings = settings_of(case)
    settings.is_settled = True
    axes = tuple(settings.rig.axis)
    program = _program(case.program, axes)
    mistakes = Mistakes()
    for error in _wrong_metrics(case, axes, programs_of(settings, program).values()):
        mistakes.add(error)
    for error in _wrong_variables(case, settings, program):
        mistakes.add(error)
    mistakes.refuse(case.file or case.rig)
    return Prepared(settings, program)


def _ends(case: Case) -> list[Case]:
    """Return the probes of a case that searches at both ends of its range."""
    assert case.search is not None
    ends = enumerate((case.search.first, case.search.last), start=1)
    return [probe_of(case, number, case.search.value(end)) for number, end in ends]


WHOLE_MAX = 100
"""Of so many cases at most the machine is built before the first run."""


def built_first(cases: Sequence[Case]) -> list[int]:
    """Return the places of the cases whose machine is built before the first run.

    All of a plan of common size; of more the first ones of each kind: with the same rig, program,
    inputs and checks rows differ in values only, and a machine takes ten times as long as to read
    these.
    """
    if len(cases) <= WHOLE_MAX:
        return list(range(len(cases)))
    first: dict[Hashable, int] = {}
    for place, case in enumerate(cases):
        searched = None if case.search is None else case.search.column
        metrics = tuple(check.metric for check in (*case.checks, *case.sampled))
        module = None if case.module is None else (case.module.name, case.module.path)
        kind = (case.rig, case.program, module, tuple(case.inputs), metrics, searched)
        first.setdefault(kind, place)
    return sorted(first.values())[:WHOLE_MAX]


def _wrong_variables(case: Case, settings: Settings, program: Program) -> Iterator[UserError]:
    """Find V.E. variables in cells of the row itself that nothing uses: they act on nothing."""
    used = None
    for item in case.assignments():
        place = case.places.get(item.column)
        is_own = place is not None and (place.file, place.line) == (case.file, case.line)
        if is_own and item.column not in case.overridden and is_variable(item):
            used = used or used_variables(settings, case.program, program)
            if not used.has(item.column):
                error = used.error(item, case.program)
                yield case.error(error.message, item.column, value=item.value, hint=error.hint)


def _wrong_metrics(
    case: Case, axes: Sequence[str], programs: Iterable[Program]
) -> Iterator[UserError]:
    """Find checks of axes that the rig, and of blocks that the programs, do not have."""
    programs = list(programs)
    blocks = _printing(programs)
    for check in (*case.checks, *case.sampled):
        column = f"check:{check.metric}"
        if check.axis is not None and check.axis not in axes:
            yield case.error("the rig has no such axis", column, value=check.axis, allowed=axes)
        if check.block is not None and check.block[0] not in blocks:
            blocks = _printing(unit.program for one in programs for unit in reachable(link(one)))
        if check.block is not None and check.block[0] not in blocks:
            yield case.error(
                "the program has no #MSG in such a block",
                column,
                value=check.block[0],
                allowed=blocks or "none",
            )


def _printing(programs: Iterable[Program]) -> list[str]:
    """Return the numbers of the blocks with a `#MSG`, those of local subprograms too."""
    found = [
        part.block.number
        for program in programs
        for blocks in (program.blocks, *program.subprograms.values())
        for part in blocks
        if isinstance(part.statement, Command) and part.statement.name.startswith("MSG")
    ]
    return [f"N{number}" for number in dict.fromkeys(found) if number is not None]
