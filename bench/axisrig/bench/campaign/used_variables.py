"""Which V.E. variables of a row something reads: its programs, moments of cells, its PLC program.

A name that a PLC program computes at run time counts as used, whatever it is.
"""

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from axisrig.bench.plan.assignment import Assignment
from axisrig.bench.rig.plc.words import VARIABLE
from axisrig.bench.rig.programs import programs_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.nc.decoder.base.subprograms import link, reachable
from axisrig.kernel.nc.syntax import Program

_VARIABLE = re.compile(rf"{re.escape(VARIABLE)}(\w+)", re.IGNORECASE)
_OF_HLI = "ve"
"""Attribute of the HLI that holds the variables, by their names."""


@dataclass(frozen=True)
class Used:
    """Names of variables, upper case, that are used. all_may: any name may be."""

    names: frozenset[str]
    all_may: bool

    def has(self, column: str) -> bool:
        """Return whether the variable of a column `plc:V.E.NAME` is used, or may be."""
        name = column.partition(VARIABLE)[2].upper()
        return self.all_may or name in self.names

    def error(self, item: Assignment, program: Path) -> UserError:
        """Make the error of a column that nothing uses, without its place."""
        known = sorted(f"{VARIABLE}{name}" for name in self.names)
        name = item.column.removeprefix("plc:")
        return UserError(
            f"{item.column} is not used: {program.name} and the PLC program of the rig have"
            f" {', '.join(known) or 'no variable of the PLC'}",
            value=item.value,
            hint=f"did you mean {near[0]}?" if (near := list(nearest(name, known))) else None,
        )


def is_variable(item: Assignment) -> bool:
    """Return whether an input is a V.E. variable."""
    return item.kind == "plc" and item.name.startswith(VARIABLE)


def used_variables(settings: Settings, program: Path, parsed: Program) -> Used:
    """Return the variables that the programs of a row, its cells and its PLC program use."""
    files = {
        Path(unit.program.file)
        for each in programs_of(settings, parsed).values()
        for unit in reachable(link(each))
        if unit.program.file is not None
    } or {program}
    found = [name for file in files for name in _in_text(file.read_bytes())]
    rules = settings.plc
    moments = [moment for rule in rules for moment in (rule.moment, rule.until) if moment]
    found += [name for moment in moments for name in _VARIABLE.findall(moment.word)]
    for part in (settings.channel, *settings.axis.values()):
        found += [name for text in part.words() for name in _VARIABLE.findall(text)]
    all_may = False
    if (task := settings.rig.plc_task) is not None and task.program is not None:
        names, all_may = _in_plc_program(Path(task.program).read_bytes())
        found += names
    return Used(frozenset(name.upper() for name in found), all_may)


@lru_cache(maxsize=64)
def _in_text(content: bytes) -> list[str]:
    """Names of the V.E. variables in the text of an NC program."""
    return _VARIABLE.findall(content.decode(errors="replace"))


@lru_cache(maxsize=16)
def _in_plc_program(content: bytes) -> tuple[list[str], bool]:
    """Names in a PLC program that may be those of variables; whether it computes some.

    Every text in it counts: a name may be kept in a table. It computes names where `ve` is read by
    something that is no text, or is handed on as a whole.
    """
    try:
        tree = ast.parse(content)
    except (SyntaxError, ValueError):
        return [], True  # it is refused where it is loaded
    texts = [node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)]
    names = [text.removeprefix(VARIABLE) for text in texts if isinstance(text, str)]
    plain = {id(node) for node in _plain_uses(tree)}
    all_may = any(
        isinstance(node, ast.Attribute) and node.attr == _OF_HLI and id(node) not in plain
        for node in ast.walk(tree)
    )
    return names, all_may


def _plain_uses(tree: ast.AST) -> Iterator[ast.expr]:
    """Uses of `ve` by a name that is written there: `ve["A"]`, `ve.get("A", 0)`, `"A" in ve`."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant):
            yield node.value
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            if node.func.attr == "get" and node.args and isinstance(node.args[0], ast.Constant):
                yield node.func.value
        elif isinstance(node, ast.Compare) and isinstance(node.left, ast.Constant):
            yield from node.comparators
