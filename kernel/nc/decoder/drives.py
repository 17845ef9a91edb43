"""Functions of the drives (#DRIVE)."""

from collections.abc import Iterator

from kernel.nc import canon
from kernel.nc.canon import Block
from kernel.nc.decoder.context import Context
from kernel.nc.decoder.topic import Topic
from kernel.nc.syntax import Command, Expression, Name, Variable


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


TOPIC = Topic(
    commands={
        "DRIVE WR SYN": _write,
        "DRIVE WR": _write,  # drive functions are written synchronously only (207630987)
        "DRIVE WAIT SYN": _wait,
        "DRIVE RD": _read,
    }
)
