"""The files that a run reads: programs and their subprograms, rig, lists, maps, FMUs, metrics."""

import re
from functools import lru_cache
from pathlib import Path

from axisrig.bench.files import sha256_of
from axisrig.bench.plan.case import Case
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.reading.sources import rig_files
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.decoder.base.subprograms import link, reachable
from axisrig.kernel.nc.text.parser import read_program


def started_programs(case: Case) -> list[Path]:
    """Programs that the PLC side starts."""
    files = re.findall(r"\bfile=(\S+?)(?=[\s;]|$)", case.inputs.get("plc:program_start", ""))
    return [case.program.parent / file for file in files]


def own_metrics(case: Case) -> list[Path]:
    """The Python file with metrics of the user, where the plan names one."""
    return [] if case.module is None or case.module.path is None else [case.module.path]


def subprograms_of(case: Case) -> list[Path]:
    """Files that the programs of a run can call. Raises UserError where one cannot be read."""
    axes = _axes(case.rig, _state(case.rig))
    programs = [case.program, *started_programs(case)]
    called = [file for each in programs for file in _programs(each, axes, _state(each))]
    return [file for file in dict.fromkeys(called) if file not in programs]


def readable_subprograms(case: Case) -> list[Path]:
    """These files, none where a program or the rig cannot be read: its run says why."""
    try:
        return subprograms_of(case)
    except UserError:
        return []


def rig_parts(case: Case) -> list[Path]:
    """What a rig is made of beside its file: bases, lists, maps, FMUs, maps that cells name."""
    maps = [Path(item.value) for item in case.assignments() if item.names_file]
    return [*_of_rig(case.rig, _state(case.rig))[1:], *maps]


def files_of_case(case: Case) -> list[Path]:
    """Every file that a run reads, each once. Raises UserError where one cannot be read."""
    programs = [case.program, *started_programs(case), *subprograms_of(case)]
    return list(dict.fromkeys([*programs, *own_metrics(case), case.rig, *rig_parts(case)]))


def content_hash(path: Path) -> str:
    """SHA-256 of a file, remembered until it is written; empty where there is none."""
    return _hash(path, _state(path))


State = tuple[int, int, int] | None


def _state(path: Path) -> State:
    """What changes when a file is written; None where there is none."""
    try:
        state = path.stat()
    except OSError:
        return None
    return state.st_mtime_ns, state.st_size, state.st_ino


@lru_cache(maxsize=4096)
def _hash(path: Path, state: State) -> str:
    return "" if state is None else sha256_of(path)


@lru_cache(maxsize=256)
def _of_rig(rig: Path, _state: State) -> tuple[Path, ...]:
    return tuple(rig_files(rig))


@lru_cache(maxsize=256)
def _axes(rig: Path, _state: State) -> tuple[str, ...]:
    return tuple(read_rig(rig)[0].axis)


@lru_cache(maxsize=1024)
def _programs(program: Path, axes: tuple[str, ...], _state: State) -> tuple[Path, ...]:
    """A program and the files of the subprograms that it can reach."""
    units = reachable(link(read_program(program, axes)))
    return tuple(Path(unit.program.file) for unit in units if unit.program.file is not None)
