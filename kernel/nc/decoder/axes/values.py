"""Reading what stands in the brackets of axis commands."""

from kernel.nc.canon import Block
from kernel.nc.decoder.context import Context
from kernel.nc.syntax import Argument, Command, Group, Name


def brackets(command: Command) -> tuple[Group, ...]:
    """Give the brackets of a command, of which a table may make arguments of the command."""
    groups = tuple(a for a in command.arguments if isinstance(a, Group))
    if groups and len(groups) == len(command.arguments):
        return groups
    return (Group(command.arguments, command.options),)


def whole(context: Context, block: Block, argument: Argument) -> int | None:
    """Give the value of an expression that stands for a whole number; None if it does not."""
    if argument is None or isinstance(argument, Name | Group):
        return None
    value = context.value(block, argument)
    return int(value) if value == int(value) else None


def shown(context: Context, block: Block, argument: Argument) -> str:
    """Give what stands in a program for a message."""
    if argument is None or isinstance(argument, Group):
        return "nothing"
    if isinstance(argument, Name):
        return argument.value
    return f"{context.value(block, argument):g}"


def axis_named(context: Context, argument: Argument) -> str | None:
    """Give the axis of the channel that a name stands for; None for anything else."""
    if not isinstance(argument, Name):
        return None
    names = {axis.upper(): axis for axis in context.axes}
    return names.get(argument.value.upper())
