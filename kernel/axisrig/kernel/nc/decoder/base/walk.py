"""Finds the variables inside statements."""

from collections.abc import Hashable, Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any

from axisrig.kernel.nc.syntax import (
    Assign,
    AxisCommand,
    Command,
    Declare,
    For,
    Name,
    Number,
    Statement,
    Text,
    Variable,
    Words,
)

# Keywords that name a variable: nobody reads it while the block is decoded
_NAMES = ("SENSOR_VAR",)
_PLAIN = (str, int, float, bool, type(None), Number, Text, Name)


@cache
def _field_names(kind: Hashable) -> tuple[str, ...]:
    assert isinstance(kind, type)
    return tuple(field.name for field in fields(kind)) if is_dataclass(kind) else ()


def variables_in(node: Any) -> Iterator[Variable]:
    """Give every variable inside a statement, a value or a tuple of them."""
    if isinstance(node, _PLAIN):
        return
    if isinstance(node, tuple):
        for part in node:
            yield from variables_in(part)
        return
    if isinstance(node, Variable):
        yield node
    for name in _field_names(node.__class__):
        yield from variables_in(getattr(node, name))


def read_by(statement: Statement) -> Iterator[Variable]:
    """Give every variable whose value a statement may need."""
    match statement:
        case Assign(target, value):
            yield from variables_in((target.indices, value))
        case Declare(_, values):
            yield from variables_in(values)
        case For(variable, first, last, step):
            yield from variables_in((variable.indices, first, last, step))
        case Words(axis_commands=commands) if commands:
            yield from variables_in((statement.axes, statement.addresses))
            for command in commands:
                yield from _read_by_command(command)
        case Command():
            yield from _read_by_command(statement)
        case _:
            yield from variables_in(statement)


def _read_by_command(command: AxisCommand | Command) -> Iterator[Variable]:
    yield from variables_in(command.arguments)
    for keyword, option in command.options:
        if keyword in _NAMES and isinstance(option, Variable):
            yield from variables_in(option.indices)
        else:
            yield from variables_in(option)


def written_by(statement: Statement) -> Iterator[Variable]:
    """Give every variable that a statement may give a value, by whatever command."""
    match statement:
        case Assign(target) | Declare(target) | For(target):
            yield target
        case Command():
            # A keyword such as P of #DRIVE RD takes the variable that gets the value
            for _, option in statement.options:
                if isinstance(option, Variable):
                    yield option
