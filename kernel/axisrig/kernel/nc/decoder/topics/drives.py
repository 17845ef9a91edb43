"""Functions of the drives (#DRIVE), their idents (#IDENT) and procedure commands (#COMMAND)."""

from collections.abc import Iterator, Sequence
from typing import Final

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Topic
from axisrig.kernel.nc.syntax import Command, Expression, Name, Variable

DIGITS_MAX: Final = 9  # DEC of #IDENT
COMMAND_BYTES: Final = 2
RUN: Final = 3
"""Value with which a procedure command runs."""


def _name(command: Command, keyword: str) -> str:
    name = command.option(keyword)
    assert isinstance(name, Name), "the table of commands has checked it"
    return name.value


def _axis(context: Context, block: Block, command: Command) -> str:
    number = command.option("AXNR")
    if isinstance(number, Expression):
        return context.numbered_axis(block, number)
    return _name(command, "AX")


def _write(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    value = command.option("VAL")
    assert isinstance(value, Expression)
    number = context.value(block, value)
    axis, key = _axis(context, block, command), _name(command, "KEY")
    yield canon.DriveWrite(block, axis, key, number, command.has("WAIT"))


def _wait(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    yield canon.DriveWait(block, _axis(context, block, command))


def _read(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    axis, key = _axis(context, block, command), _name(command, "KEY")
    variable = command.option("P")
    assert isinstance(variable, Variable)
    yield canon.DriveRead(block, axis, key)
    yield canon.Wait(block)
    value = context.machine.drive_value(axis, key)
    yield from context.write(block, variable, value)


def _ident_write(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#IDENT WR [SYN]; the smallest digit of DEC counts one in the drive."""
    value = command.option("VAL")
    assert isinstance(value, Expression)
    axis, name, length_bytes, digits = _ident(context, block, command)
    number = context.value(block, value) * digits
    waits = not command.has("NO_WAIT")
    yield canon.DriveWrite(block, axis, name, number, waits, length_bytes)


def _ident_read(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    axis, name, length_bytes, digits = _ident(context, block, command)
    variable = command.option("P")
    assert isinstance(variable, Variable)
    yield canon.DriveRead(block, axis, name, length_bytes)
    yield canon.Wait(block)
    value = context.machine.drive_value(axis, name) / digits
    yield from context.write(block, variable, value)


def _ident(context: Context, block: Block, command: Command) -> tuple[str, str, int, float]:
    """Axis, name, length in bytes (TYP) and what 1 is in smallest digits (DEC)."""
    numbers = []
    for keyword, allowed in (("TYP", (2, 4)), ("DEC", range(DIGITS_MAX + 1))):
        expression = command.option(keyword)
        assert isinstance(expression, Expression)
        number = context.value(block, expression)
        if number not in allowed:
            listed = ", ".join(map(str, allowed))
            raise context.alarm(900256, block, keyword=keyword, value=f"{number:g}", allowed=listed)
        numbers.append(int(number))
    length_bytes, decimals = numbers
    axis, name = _axis(context, block, command), _name(command, "ID").upper()
    return axis, name, length_bytes, 10.0**decimals


def _ident_wait(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#IDENT WAIT SYN: of one axis, without one of all."""
    for axis in _axes(context, block, command):
        yield canon.DriveWait(block, axis)


def _axes(context: Context, block: Block, command: Command) -> Sequence[str]:
    is_one = command.has("AX") or command.has("AXNR")
    return (_axis(context, block, command),) if is_one else tuple(context.axes)


def _start(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#COMMAND WR [SYN]: the ident of the procedure command gets 3, and runs from then on."""
    axis, name = _axis(context, block, command), _name(command, "ID").upper()
    yield canon.DriveWrite(block, axis, name, RUN, True, COMMAND_BYTES, is_command=True)


def _end(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#COMMAND WAIT SYN: until the command has ended, without ID until all have."""
    name = _name(command, "ID").upper() if command.has("ID") else ""
    for axis in _axes(context, block, command):
        yield canon.DriveWait(block, axis, commands=True, key=name)


TOPIC = Topic(
    commands={
        "DRIVE WR SYN": _write,
        "DRIVE WR": _write,  # drive functions are written synchronously only (207630987)
        "DRIVE WAIT SYN": _wait,
        "DRIVE RD": _read,
        "IDENT WR SYN": _ident_write,
        "IDENT WR": _ident_write,
        "IDENT RD": _ident_read,
        "IDENT RD SYN": _ident_read,
        "IDENT WAIT SYN": _ident_wait,
        "COMMAND WR SYN": _start,
        "COMMAND WR": _start,
        "COMMAND WAIT SYN": _end,
    }
)
