"""Reading what is in the brackets of axis commands."""

from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.expressions import whole_number
from axisrig.kernel.nc.syntax import Argument, Command, Group, Name, Text


def brackets(command: Command) -> tuple[Group, ...]:
    """Give the brackets of a command, of which a table may make arguments of the command."""
    groups = tuple(a for a in command.arguments if isinstance(a, Group))
    if groups and len(groups) == len(command.arguments):
        return groups
    return (Group(command.arguments, command.options),)


def number(context: Context, block: Block, argument: Argument) -> float | None:
    """Give the value of an expression; None for anything else."""
    if argument is None or isinstance(argument, Name | Group):
        return None
    return context.value(block, argument)


def whole(context: Context, block: Block, argument: Argument) -> int | None:
    """Give the value of an expression that is a whole number; None if it does not."""
    value = number(context, block, argument)
    return None if value is None else whole_number(value)


def shown(context: Context, block: Block, argument: Argument) -> str:
    """Give what is written in a program for a message."""
    if argument is None:
        return "nothing"
    if isinstance(argument, Group):
        return "a bracket"
    if isinstance(argument, Text):
        return f'"{argument.value}"'
    if isinstance(argument, Name):
        return argument.value
    return f"{context.value(block, argument):g}"


def axis_named(context: Context, argument: Argument) -> str | None:
    """Give the axis of the channel that a name means; None for anything else."""
    if not isinstance(argument, Name):
        return None
    names = {axis.upper(): axis for axis in context.axes}
    return names.get(argument.value.upper())
