"""Machining coordinate systems (#CS)."""

from kernel.nc.canon import Block
from kernel.nc.coordinates import Frame
from kernel.nc.decoder.context import Context
from kernel.nc.decoder.topic import Topic, silent
from kernel.nc.syntax import Command, Expression

COMPONENTS = 6


def _on(context: Context, block: Block, command: Command) -> None:
    """#CS ON with three shifts in mm and three angles in degrees; what is left out is 0."""
    if len(command.arguments) <= 1:
        raise context.alarm(900100, block, word="#CS ON", what="stored coordinate system")
    values = [0.0] * COMPONENTS
    for place, argument in enumerate(command.arguments):
        if isinstance(argument, Expression):
            values[place] = context.value(block, argument)
    context.coordinates.switch_on(Frame.of(values))


def _off(context: Context, block: Block, command: Command) -> None:
    if command.name == "CS OFF ALL":
        context.coordinates.switch_off_all()
    elif context.coordinates.transformed:
        context.coordinates.switch_off()
    else:
        raise context.alarm(900108, block)


TOPIC = Topic(commands={"CS ON": silent(_on), "CS OFF": silent(_off), "CS OFF ALL": silent(_off)})
