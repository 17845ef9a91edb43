"""Cells of a plan that can be run and are hardly meant: a variable that nobody reads, no unit."""

import re
from collections.abc import Iterable, Iterator
from functools import lru_cache
from pathlib import Path

from axisrig.bench.campaign.preparing import Prepared
from axisrig.bench.plan.assignment import Assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.table import Place
from axisrig.bench.rig.plc.words import VARIABLE
from axisrig.bench.rig.programs import programs_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.nc.decoder.base.subprograms import link, reachable

Cells = tuple[Place | None, str]
"""Place of a cell, None on the command line, and its column: a default is one cell of many rows."""

_VARIABLE = re.compile(rf"{re.escape(VARIABLE)}(\w+)", re.IGNORECASE)


class CellWarnings:
    """Collects what is to be said of the cells of a plan, case by case."""

    def __init__(self) -> None:
        self._unread: dict[Cells, str] = {}
        self._read: set[Cells] = set()
        self._bare: dict[Cells, str] = {}

    def look(self, case: Case, prepared: Prepared) -> None:
        """Look at the inputs of a case."""
        variables: set[str] | None = None
        for item in case.assignments():
            cell = (None if item.column in case.overridden else case.places.get(item.column),
                    item.column)  # fmt: skip
            if item.column in prepared.settings.bare:
                self._bare[cell] = bare_warning(prepared.settings, item)
            if item.kind == "plc" and item.name.startswith(VARIABLE):
                variables = _used(prepared) if variables is None else variables
                name = item.name.removeprefix(VARIABLE)
                if prepared.settings.rig.plc_task or name.upper() in variables:
                    self._read.add(cell)
                else:
                    self._unread[cell] = _unread(item, case.program, variables)

    def lines(self) -> Iterator[str]:
        """Yield the warnings, those of one cell once."""
        unread = {cell: text for cell, text in self._unread.items() if cell not in self._read}
        for (place, _), text in [*unread.items(), *self._bare.items()]:
            where = "" if place is None else f"{place.file}:{place.line}:{place.column}: "
            yield where + text


def bare_warning(settings: Settings, item: Assignment) -> str:
    """Say in which unit a value counts whose column names none."""
    unit, columns = settings.bare[item.column]
    named = " or ".join(columns)
    return f"{item.column} names no unit, so {item.value} counts in {unit}; with a unit: {named}"


def _unread(item: Assignment, program: Path, variables: Iterable[str]) -> str:
    known = ", ".join(f"{VARIABLE}{name}" for name in sorted(variables)) or "no variable of the PLC"
    return f"{item.column} is not used: {program.name} has {known}"


@lru_cache(maxsize=64)
def _variables(content: bytes) -> list[str]:
    """Names of the V.E. variables in the text of a program."""
    return _VARIABLE.findall(content.decode(errors="replace"))


def _used(prepared: Prepared) -> set[str]:
    """Names of the V.E. variables, upper case, in the texts of programs and in moments of cells."""
    programs = programs_of(prepared.settings, prepared.program).values()
    files = {
        Path(unit.program.file)
        for program in programs
        for unit in reachable(link(program))
        if unit.program.file is not None
    }
    rules = prepared.settings.plc
    moments = [moment for rule in rules for moment in (rule.moment, rule.until) if moment]
    found = [name for file in files for name in _variables(file.read_bytes())]
    found += [moment.word.removeprefix(VARIABLE) for moment in moments]
    return {name.upper() for name in found}
